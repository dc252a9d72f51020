import numpy as np
import pinocchio as pin
import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.scene.robot_description import toolPoses
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.kinematics import make_kinematics

URDF = asset_path("robots", "iiwa7", "iiwa7.urdf")


@pytest.fixture(scope="module")
def postures(robot):
    return np.random.default_rng(20).uniform(*robot.limits, (10_000, 7))


@pytest.mark.parametrize("count", [300, pytest.param(10_000, marks=pytest.mark.soak)])
def test_numpy_equals_pinocchio_to_1e_12_in_random_postures(robot, postures, count):
    ours, theirs = make_kinematics(robot, "numpy"), make_kinematics(robot, "pinocchio")
    for q in postures[:count]:
        links, expected = ours.links(q), theirs.links(q)
        assert np.abs(ours.tip(q) - theirs.tip(q)).max() <= 1e-12
        assert links.keys() == expected.keys()
        difference = max(np.abs(links[n] - expected[n]).max() for n in links)
        assert difference <= 1e-12


@pytest.mark.parametrize("backend", ["numpy", "pinocchio"])
def test_the_kinematics_agree_with_pinocchios_own_reading_of_the_urdf(robot, postures, backend):
    kinematics = make_kinematics(robot, backend)
    model = pin.buildModelFromUrdf(str(URDF))
    data = model.createData()
    for q in postures[:50]:
        pin.framesForwardKinematics(model, data, q)
        for name, pose in kinematics.links(q).items():
            expected = data.oMf[model.getFrameId(name)].homogeneous
            np.testing.assert_allclose(pose, expected, rtol=0, atol=1e-12)


def test_the_environment_variable_chooses_the_backend(robot, monkeypatch):
    monkeypatch.setenv("RASTRAINER_KINEMATICS", "numpy")
    assert type(make_kinematics(robot)).__name__ == "NumpyKinematics"
    monkeypatch.setenv("RASTRAINER_KINEMATICS", "")
    assert type(make_kinematics(robot)).__name__ == "PinocchioKinematics"
    monkeypatch.setenv("RASTRAINER_KINEMATICS", "orocos")
    with pytest.raises(InputError, match="should be one of pinocchio, numpy"):
        make_kinematics(robot)


def test_the_tool_is_where_the_simulators_kinematics_place_it(robot, postures):
    kinematics = make_kinematics(robot, "numpy")
    for q, pose in zip(postures[:50], toolPoses(URDF, postures[:50]), strict=True):
        expected = kinematics.tip(q)
        np.testing.assert_allclose(pose[:3, :3], expected[:3, :3], atol=1e-9)
        np.testing.assert_allclose(pose[:3, 3], MM_PER_M * expected[:3, 3], atol=1e-6)


def test_an_invalid_chain_is_refused_in_one_sentence(tmp_path):
    for old, new in (
        ('type="revolute"', 'type="prismatic"'),
        ('<parent link="iiwa_link_1" />', '<parent link="iiwa_link_0" />'),
        ('<axis xyz="0 0 1" />', '<axis xyz="up" />'),
    ):
        (tmp_path / "arm.urdf").write_text(URDF.read_text().replace(old, new))
        with pytest.raises(InputError, match="URDF"):
            toolPoses(tmp_path / "arm.urdf", np.zeros((1, 7)))
