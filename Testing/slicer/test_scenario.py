"""A scenario stands in the scene: head, target and the fiducials of a task."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.control_points import labelsOf, worldPoints
from rastrainer.slicer.scenario import showScenario, showTask
from rastrainer.slicer.scene import Role, findNode

FIDUCIALS = "vtkMRMLMarkupsFiducialNode"


def test_head_and_target_are_shown_in_ras(scene, scenario):
    showScenario(scene, scenario)
    bounds = [0.0] * 6
    findNode(scene, "vtkMRMLModelNode", Role.HEAD_MODEL).GetRASBounds(bounds)
    np.testing.assert_allclose(bounds, [-90.0, 90.0] * 3, atol=1.0)
    target = findNode(scene, FIDUCIALS, Role.TARGET)
    np.testing.assert_allclose(worldPoints(target), [scenario.target_position])
    assert labelsOf(target) == ("center",)


def test_showing_a_scenario_again_adds_no_node(scene, scenario):
    showScenario(scene, scenario)
    showTask(scene, scenario, "task-1")
    count = scene.GetNumberOfNodes()
    showScenario(scene, scenario)
    showTask(scene, scenario, "task-2")
    assert scene.GetNumberOfNodes() == count


def test_the_fiducials_of_a_task_are_numbered_and_locked(scene, scenario):
    node = showTask(scene, scenario, "task-2")
    assert node.GetName() == "Task 2 fiducials"
    assert labelsOf(node) == tuple(str(number) for number in range(1, 16))
    np.testing.assert_allclose(worldPoints(node), scenario.task("task-2").fiducials)
    assert node.GetLocked()


def test_our_nodes_are_found_when_users_rename_them(scene, scenario):
    node = showTask(scene, scenario, "task-1")
    node.SetName("my points")
    assert showTask(scene, scenario, "task-1") is node


def test_an_unknown_task_gets_a_sentence(scene, scenario):
    with pytest.raises(InputError, match="it has trial-run, task-1, task-2"):
        showTask(scene, scenario, "task-9")
