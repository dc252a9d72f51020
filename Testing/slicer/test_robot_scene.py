"""The robot is in the 3D view and follows the poses that the link brings."""

import numpy as np
import pytest
import slicer

from rastrainer.errors import InputError
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.robot import addLink, missingLinks, setRobotVisible
from rastrainer.slicer.scene.robot_description import readLinkMeshes
from rastrainer.slicer.scene.scenario_nodes import showTask
from rastrainer.slicer.scene.trial_scene import followPlacement, setApplied, showPlannedPlace
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot

ROBOT = asset_path("robots", "iiwa7")


def bounds(node):
    values = [0.0] * 6
    node.GetRASBounds(values)
    return np.array(values)


@pytest.fixture(scope="module")
def links():
    return readLinkMeshes(ROBOT)


@pytest.fixture
def robot(scene, links):
    for number in missingLinks(scene):
        addLink(scene, number, links[number])
    followPlacement(scene)
    return [Role.LINKS[number].find(scene) for number in range(8)]


def test_each_link_is_one_colored_model_that_is_hidden_and_not_saved_with_the_scene(scene, robot):
    for node in robot:
        assert node.GetPolyData().GetNumberOfCells() > 1000
        colors = slicer.util.arrayFromModelPointData(node, "color")
        assert len(np.unique(colors, axis=0)) > 1
        normals = slicer.util.arrayFromModelPointData(node, "Normals")
        np.testing.assert_allclose(np.linalg.norm(normals, axis=1), 1.0, atol=1e-4)
        assert not node.GetSaveWithScene()
    assert missingLinks(scene) == []
    setRobotVisible(scene, False)
    assert not any(node.GetDisplayVisibility() for node in robot)


def test_the_robot_moves_with_the_poses_of_its_links(scene, robot):
    model = load_robot()
    poses = make_kinematics(model).links(model.home)
    for number in range(8):
        pose = np.array(poses[f"iiwa_link_{number}"])
        pose[:3, 3] *= MM_PER_M
        node = scene.GetFirstNode(f"Link{number}ToWorld", "vtkMRMLLinearTransformNode")
        node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(pose))
    tip = MM_PER_M * np.array(poses["iiwa_tool_tip_ee"])[:3, 3]
    hand = bounds(robot[7])
    # The tool belongs to link 7: its lowest point is the tip, which points down at home.
    assert hand[4] == pytest.approx(tip[2], abs=1.0)
    assert hand[0] - 1 <= tip[0] <= hand[1] + 1
    np.testing.assert_allclose(bounds(robot[0])[4], 0.0, atol=1.0)


def test_the_robot_is_where_its_touches_are_shown(scene, robot, scenario):
    fixed = showTask(scene, scenario, "task-1")
    transform = showPlannedPlace(scene, scenario, fixed)
    in_world = bounds(robot[0])
    followPlacement(scene)
    on_head = bounds(robot[0])
    # The scenario turns the head by half a turn and puts it at x = 500, z = 300.
    np.testing.assert_allclose(on_head[[0, 1]], 500.0 - in_world[[1, 0]], atol=1e-3)
    np.testing.assert_allclose(on_head[[4, 5]], in_world[[4, 5]] - 300.0, atol=1e-3)
    setApplied(transform, False)
    followPlacement(scene)
    np.testing.assert_allclose(bounds(robot[0]), in_world)


def test_a_missing_or_malformed_robot_is_reported(tmp_path):
    with pytest.raises(InputError, match="There is no file"):
        readLinkMeshes(tmp_path)
    text = (ROBOT / "iiwa7.urdf").read_text(encoding="utf-8")
    for before, after, problem in (
        ("", "", r"mesh .*stl is missing"),
        ("<child ", "<offspring ", "<child> with link"),
        ("rgba=", "rgb=", "<color> with rgba"),
        ("</robot>", "", "cannot be used"),
    ):
        (tmp_path / "iiwa7.urdf").write_text(text.replace(before, after), encoding="utf-8")
        with pytest.raises(InputError, match=problem):
            readLinkMeshes(tmp_path)
