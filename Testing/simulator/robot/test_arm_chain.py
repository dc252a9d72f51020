"""The tool's pose from the URDF alone is that of the simulator's kinematics."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.scene.urdf import readArmChain
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot

URDF = asset_path("robots", "iiwa7", "iiwa7.urdf")


def test_the_tool_is_where_the_simulators_kinematics_have_it():
    robot = load_robot()
    kinematics, chain = make_kinematics(robot, "numpy"), readArmChain(URDF)
    postures = np.random.default_rng(5).uniform(robot.lower, robot.upper, (200, 7))
    assert chain.moving == 7
    for q, pose in zip(postures, chain.toolToWorld(postures), strict=True):
        expected = kinematics.tip(q)
        np.testing.assert_allclose(pose[:3, :3], expected[:3, :3], atol=1e-9)
        np.testing.assert_allclose(pose[:3, 3], MM_PER_M * expected[:3, 3], atol=1e-6)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('type="revolute"', 'type="prismatic"'),
        ('<parent link="iiwa_link_1" />', '<parent link="iiwa_link_0" />'),
        ('<child link="iiwa_link_1" />', ""),
        ('<axis xyz="0 0 1" />', '<axis xyz="up" />'),
        ("<robot", "<!DOCTYPE x><robot"),
    ],
)
def test_what_is_no_chain_is_one_sentence(old, new, tmp_path):
    (tmp_path / "arm.urdf").write_text(URDF.read_text().replace(old, new))
    with pytest.raises(InputError, match="URDF"):
        readArmChain(tmp_path / "arm.urdf")
