"""What the scene shows of a scenario: a head, a task's fiducials, and the robot."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.scenario import Scenario
from rastrainer.scenario_library import ListedScenario
from rastrainer.slicer.link_nodes import capturedPointsNode
from rastrainer.slicer.polydata import trianglesPolyData
from rastrainer.slicer.robot_scene import robotNode, setRobotVisible, showRobot
from rastrainer.slicer.scenario import SKIN_COLOR, showScenario, showTask
from rastrainer.slicer.scenario_shelf import ScenarioShelf
from rastrainer.slicer.scene import ROLE_ATTRIBUTE, Role, findNode
from rastrainer.slicer.world_placement import isPlanned, showPlannedPlace


class ScenarioDesk:
    """What the Scenario panel does."""

    def __init__(self, scene: Any, shelf: ScenarioShelf, robotFolder: Path) -> None:
        self._scene = scene
        self._shelf = shelf
        self._robotFolder = robotFolder

    def listed(self) -> tuple[ListedScenario, ...]:
        """Return the scenarios that come with the module and those of the user."""
        return self._shelf.listed()

    def find(self, scenarioName: str) -> Scenario:
        """Return the scenario of that name; raise `InputError` if there is none."""
        return self._shelf.find(scenarioName)

    def show(self, scenarioName: str, taskName: str) -> None:
        """Show a scenario's head and the fiducials of one of its tasks.

        Raises:
            InputError: there is no such scenario or task, or its files cannot be used.
        """
        scenario = self._shelf.find(scenarioName)
        showScenario(self._scene, scenario)
        fixed = showTask(self._scene, scenario, taskName)
        placed = findNode(self._scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
        if placed is None or isPlanned(placed):
            showPlannedPlace(self._scene, scenario, capturedPointsNode(self._scene), fixed)

    def useHead(
        self, node: Any, progress: Callable[[str, float], None] = lambda _step, _share: None
    ) -> Any:
        """Let a model or a volume of the scene be the head that is looked at; return its model.

        The head that was one before is hidden, and is no longer ours to fill.

        Args:
            node: a `vtkMRMLModelNode`, or a `vtkMRMLScalarVolumeNode` whose skin is extracted.
            progress: told each step's name and the share of the work done; may raise to cancel.

        Raises:
            InputError: there is no head in the volume.
        """
        model = self._skinOf(node, progress) if node.IsA("vtkMRMLVolumeNode") else node
        former = findNode(self._scene, "vtkMRMLModelNode", Role.HEAD_MODEL)
        if former is model:
            return model
        if former is not None:
            former.RemoveAttribute(ROLE_ATTRIBUTE)
            former.SetDisplayVisibility(False)
        model.SetAttribute(ROLE_ATTRIBUTE, Role.HEAD_MODEL)
        model.CreateDefaultDisplayNodes()
        model.SetDisplayVisibility(True)
        return model

    def _skinOf(self, volume: Any, progress: Callable[[str, float], None]) -> Any:
        # Only here: scipy takes time to import.
        from rastrainer.slicer.head.extraction import extract_head
        from rastrainer.slicer.head.volume import volume_from_node

        if volume.GetImageData() is None:
            raise InputError(f"The volume {volume.GetName()} holds no image.")
        mesh = extract_head(volume_from_node(volume), progress=progress)
        model = self._scene.AddNewNodeByClass("vtkMRMLModelNode", f"Head of {volume.GetName()}")
        model.SetAndObservePolyData(trianglesPolyData(mesh.vertices, mesh.triangles))
        model.CreateDefaultDisplayNodes()
        model.GetDisplayNode().SetColor(SKIN_COLOR)
        return model

    def setRobotShown(self, shown: bool) -> None:
        """Show the robot, which follows the link by itself, or hide it.

        Raises:
            InputError: its files cannot be used.
        """
        if shown:
            showRobot(self._scene, self._robotFolder)
        setRobotVisible(self._scene, shown)

    @property
    def isRobotShown(self) -> bool:
        """Whether the robot is in the scene and visible."""
        node = robotNode(self._scene, 0)
        return node is not None and bool(node.GetDisplayVisibility())
