import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot


def test_the_limits_are_those_of_the_data_sheet(robot):
    np.testing.assert_allclose(np.degrees(robot.limits[1]), [170, 120, 170, 120, 170, 120, 175])
    np.testing.assert_array_equal(robot.limits[0], np.negative(robot.limits[1]))
    np.testing.assert_allclose(np.degrees(robot.velocity), [98, 98, 100, 130, 140, 180, 180])


def test_the_stretched_arm_is_as_long_as_the_data_sheet_says(robot):
    tip = make_kinematics(robot, "numpy").tip(np.zeros(7))
    np.testing.assert_allclose(tip[:3, 3], [0, 0, 1.266 + 0.2], atol=1e-12)


def test_other_meshes_replace_those_of_the_urdf(tmp_path, robot):
    (tmp_path / "visual").mkdir()
    (tmp_path / "visual" / "link_3.stl").touch()
    other = load_robot(mesh_folder=tmp_path)
    shown = [part for part in other.meshes if part.link == "iiwa_link_3"]
    assert [part.path for part in shown] == [tmp_path / "visual" / "link_3.stl"]
    kept = [part.path for part in other.meshes if part.link != "iiwa_link_3"]
    assert kept == [part.path for part in robot.meshes if part.link != "iiwa_link_3"]
    with pytest.raises(InputError, match="no mesh for this robot"):
        load_robot(mesh_folder=tmp_path / "empty")
