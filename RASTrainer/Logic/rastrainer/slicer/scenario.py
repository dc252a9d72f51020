"""Shows a scenario in the scene: the head, the target, and the fiducials of a task."""

from __future__ import annotations

from typing import Any

import numpy as np

from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import Scenario
from rastrainer.slicer.control_points import setPoints
from rastrainer.slicer.polydata import trianglesPolyData
from rastrainer.slicer.scene import Role, findOrAddNode
from rastrainer.tasks import Task

SCENARIO_ATTRIBUTE = "RASTrainer.scenario"
TASK_ATTRIBUTE = "RASTrainer.task"

SKIN_COLOR = (0.87, 0.72, 0.62)
FIDUCIAL_COLOR = (0.25, 0.55, 0.95)
TARGET_COLOR = (0.2, 0.75, 0.35)


def showScenario(scene: Any, scenario: Scenario) -> None:
    """Show the head's surface and the target; called again, nothing is made twice.

    Raises:
        InputError: the scenario's head mesh cannot be used.
    """
    _showHead(scene, scenario)
    _showTarget(scene, scenario)


def showTask(scene: Any, scenario: Scenario, taskName: str) -> Any:
    """Show the fiducials of a task, in RAS mm, and return their `vtkMRMLMarkupsFiducialNode`.

    Raises:
        InputError: the scenario has no task of that name.
    """
    task = scenario.task(taskName)
    node = findOrAddNode(
        scene, "vtkMRMLMarkupsFiducialNode", Role.FIXED_FIDUCIALS, f"{task.title} fiducials"
    )
    if node.GetAttribute(TASK_ATTRIBUTE) != f"{scenario.name}/{task.name}":
        _fillFiducials(node, scenario, task)
    return node


def _fillFiducials(node: Any, scenario: Scenario, task: Task) -> None:
    node.SetName(f"{task.title} fiducials")
    node.SetAttribute(TASK_ATTRIBUTE, f"{scenario.name}/{task.name}")
    setPoints(node, task.labels, task.fiducials)
    node.SetLocked(True)
    display = node.GetDisplayNode()
    display.SetSelectedColor(FIDUCIAL_COLOR)
    display.SetGlyphScale(2.0)
    display.SetTextScale(3.5)


def _showHead(scene: Any, scenario: Scenario) -> None:
    node = findOrAddNode(scene, "vtkMRMLModelNode", Role.HEAD_MODEL, "Head")
    if node.GetAttribute(SCENARIO_ATTRIBUTE) == scenario.name:
        return
    mesh = read_head_mesh(scenario.head_mesh)
    node.SetAndObservePolyData(trianglesPolyData(mesh.vertices, mesh.triangles))
    node.SetAttribute(SCENARIO_ATTRIBUTE, scenario.name)
    display = node.GetDisplayNode()
    display.SetColor(SKIN_COLOR)
    display.SetVisibility2D(True)


def _showTarget(scene: Any, scenario: Scenario) -> None:
    node = findOrAddNode(scene, "vtkMRMLMarkupsFiducialNode", Role.TARGET, "Target")
    name, position = scenario.target_name, np.asarray(scenario.target_position, dtype=float)
    setPoints(node, (name,), position.reshape(1, 3))
    node.SetLocked(True)
    node.GetDisplayNode().SetSelectedColor(TARGET_COLOR)
