"""What the scene shows of a scenario: a head, a task's fiducials, and the robot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rastrainer.progress import Progress
from rastrainer.scenario.library import ListedScenario
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.logic.head_preview import findSkin
from rastrainer.slicer.logic.scenario_cache import ScenarioCache
from rastrainer.slicer.scene.link_nodes import capturedPointsNode
from rastrainer.slicer.scene.registration_nodes import followPlacement, isPlanned, showPlannedPlace
from rastrainer.slicer.scene.robot_scene import robotNode, setRobotVisible, showRobot
from rastrainer.slicer.scene.scenario_nodes import (
    SKIN_COLOR,
    showScenario,
    showTask,
    trianglesPolyData,
)
from rastrainer.slicer.scene.scenario_volume import showImages
from rastrainer.slicer.scene.scene import ROLE_ATTRIBUTE, Role, findNode
from rastrainer.slicer.scene.trial_scene import showOnlyTouchesOf


class ScenarioLogic:
    """What the Scenario panel does."""

    def __init__(self, scene: Any, cache: ScenarioCache, robotFolder: Path, python: Path) -> None:
        """`python` runs the process that looks for heads."""
        self._scene = scene
        self._cache = cache
        self._robotFolder = robotFolder
        self._python = python

    def listed(self) -> tuple[ListedScenario, ...]:
        """Return the scenarios that come with the module and those of the user."""
        return self._cache.listed()

    def find(self, scenarioName: str) -> Scenario:
        """Return the scenario of that name; raise `InputError` if there is none."""
        return self._cache.find(scenarioName)

    def show(self, scenarioName: str, taskName: str) -> None:
        """Show a scenario's head and the fiducials of one of its tasks.

        Raises:
            InputError: there is no such scenario or task, or its files cannot be used.
        """
        scenario = self._cache.find(scenarioName)
        showScenario(self._scene, scenario)
        showImages(self._scene)
        fixed = showTask(self._scene, scenario, taskName)
        showOnlyTouchesOf(self._scene, scenario.name, taskName)
        placed = findNode(self._scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
        if placed is None or isPlanned(placed):
            showPlannedPlace(self._scene, scenario, capturedPointsNode(self._scene), fixed)

    def useHead(
        self, node: Any, progress: Progress = lambda _step, _share: None
    ) -> tuple[Any, list[str]]:
        """Let a model or a volume of the scene be the head that is looked at.

        The head that was one before is hidden, and is no longer ours to fill.

        Args:
            node: a `vtkMRMLModelNode`, or a `vtkMRMLScalarVolumeNode` whose skin is extracted.
            progress: called with each step and the share of the work done, ten times a second; it
                may let the application draw, and may raise to cancel: then nothing is left behind.

        Returns:
            The head's model, and warnings about its volume, one sentence each.

        Raises:
            InputError: the volume cannot be used, or there is no head in it.
        """
        isVolume = node.IsA("vtkMRMLVolumeNode")
        model, warnings = self._skinOf(node, progress) if isVolume else (node, [])
        former = findNode(self._scene, "vtkMRMLModelNode", Role.HEAD_MODEL)
        if former is not None and former is not model:
            former.RemoveAttribute(ROLE_ATTRIBUTE)
            former.SetDisplayVisibility(False)
        model.SetAttribute(ROLE_ATTRIBUTE, Role.HEAD_MODEL)
        model.CreateDefaultDisplayNodes()
        model.SetDisplayVisibility(True)
        return model, warnings

    def _skinOf(self, volumeNode: Any, progress: Progress) -> tuple[Any, list[str]]:
        _body, mesh, warnings = findSkin(self._python, volumeNode, None, progress)
        name = f"Head of {volumeNode.GetName()}"
        model = self._scene.AddNewNodeByClass("vtkMRMLModelNode", name)
        model.SetAndObservePolyData(trianglesPolyData(mesh.vertices, mesh.triangles))
        model.CreateDefaultDisplayNodes()
        model.GetDisplayNode().SetColor(SKIN_COLOR)
        return model, warnings

    def setRobotShown(self, shown: bool) -> None:
        """Show the robot, which follows the link by itself, or hide it.

        Raises:
            InputError: its files cannot be used.
        """
        if shown:
            showRobot(self._scene, self._robotFolder)
            # At once, so that the views can be moved to where it stands.
            followPlacement(self._scene)
        setRobotVisible(self._scene, shown)

    @property
    def isRobotShown(self) -> bool:
        """Whether the robot is in the scene and visible."""
        node = robotNode(self._scene, 0)
        return node is not None and bool(node.GetDisplayVisibility())
