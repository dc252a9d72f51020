"""Scenarios in the scene, another head in their place, and the robot."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.scenario_files import ScenarioCache
from rastrainer.slicer.background_work import BackgroundWork, inBackground
from rastrainer.slicer.polydata import meshPolyData
from rastrainer.slicer.program.child_process import Run
from rastrainer.slicer.scene.nodes import SKIN_COLOR, Role, releaseNode
from rastrainer.slicer.scene.robot import addLink, missingLinks, setRobotVisible
from rastrainer.slicer.scene.robot_description import READ_LINKS, LinkMesh
from rastrainer.slicer.scene.scenario_nodes import showImages, showScenario, showTask
from rastrainer.slicer.scene.trial_scene import (
    KIND_ATTRIBUTE,
    PLANNED,
    followPlacement,
    showOnlyTouchesOf,
    showPlannedPlace,
)
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress, no_progress

if TYPE_CHECKING:
    from rastrainer.head.mesh import HeadMesh
    from rastrainer.slicer.head.volume import HeadBody, HeadSettings


@dataclass(eq=False)
class ScenarioLogic:
    """Shows scenarios, other heads and the robot in the scene.

    Attributes:
        run: runs the functions that look for heads and read the robot, the latter in `work`.
        robotShown: emits nothing when the whole robot is in the scene.
        problemFound: emits a sentence if the robot's files cannot be used.
    """

    scene: Any
    cache: ScenarioCache
    robotFolder: Path
    run: Run
    work: BackgroundWork
    robotShown: Signal = field(default_factory=Signal)
    problemFound: Signal = field(default_factory=Signal)
    _links: tuple[LinkMesh, ...] = ()
    _isRobotComing: bool = False

    def show(
        self, scenarioName: str, taskName: str, then: Callable[[], None] = lambda: None
    ) -> None:
        """Show a scenario's head and a task's fiducials in the next turns; then call `then`."""
        scenario, later = self.cache.find(scenarioName), self.work.changeScene
        scenario.task(taskName)  # Raises before anything is shown.
        showScenario(self.scene, scenario, later)
        later(partial(showImages, self.scene))
        later(partial(showTask, self.scene, scenario, taskName))
        later(partial(showOnlyTouchesOf, self.scene, scenario.name, taskName))
        later(partial(self._showPlace, scenario, taskName))
        later(then)

    def _showPlace(self, scenario: Scenario, taskName: str) -> None:
        fixed = showTask(self.scene, scenario, taskName)
        placed = Role.WORLD_TO_HEAD.find(self.scene)
        if placed is None or placed.GetAttribute(KIND_ATTRIBUTE) == PLANNED:
            showPlannedPlace(self.scene, scenario, fixed)

    def useHead(self, node: Any, progress: Progress = no_progress) -> tuple[Any, list[str]]:
        """Make a model, or the skin of a volume, the displayed head; return it with warnings.

        The head that was one before is hidden, and is no longer ours to fill.
        """
        model, mesh, warnings = node, None, list[str]()
        if node.IsA("vtkMRMLVolumeNode"):
            _body, mesh, warnings = findSkin(self.run, node, None, progress)
        # Another head may be shown while this one is searched.
        former = Role.HEAD_MODEL.find(self.scene)
        if mesh is not None:
            model = Role.HEAD_MODEL.add(self.scene, f"Head of {node.GetName()}")
            model.SetAndObservePolyData(meshPolyData(mesh))
            model.GetDisplayNode().SetColor(SKIN_COLOR)
        if former is not None and former is not model:
            releaseNode(former)
        Role.HEAD_MODEL.dress(model).SetDisplayVisibility(True)
        return model, warnings

    def setRobotShown(self, shown: bool) -> None:
        """Show the robot, which follows the link, or hide it; its links come one by one."""

        def refuse(error: Exception) -> None:
            self._isRobotComing = False
            self.problemFound.emit(_("The robot cannot be shown. {problem}").format(problem=error))

        setRobotVisible(self.scene, shown)
        self._isRobotComing = shown
        if shown and (self._links or not missingLinks(self.scene)):
            self._addLinks(self._links)
        elif shown:
            check, folder = self.work.checkWanted, self.robotFolder
            self.work.do(lambda: self.run(READ_LINKS, check, folder), self._addLinks, refuse)

    def forgetScene(self) -> None:
        self._isRobotComing = False

    @property
    def isRobotShown(self) -> bool:
        node = Role.LINKS[0].find(self.scene)
        return self._isRobotComing or (node is not None and bool(node.GetDisplayVisibility()))

    def _addLinks(self, links: tuple[LinkMesh, ...]) -> None:
        """Add the links that are missing, one in each turn."""
        self._links = links

        def addMissing(number: int) -> None:
            if self._isRobotComing and number in missingLinks(self.scene):
                addLink(self.scene, number, links[number])
                # At once, so that the views can be moved to it.
                followPlacement(self.scene)

        def finish() -> None:
            if self._isRobotComing:
                self._isRobotComing = False
                self.robotShown.emit()

        for number in missingLinks(self.scene):
            self.work.later(partial(addMissing, number))
        self.work.later(finish)


FIND_SKIN = "rastrainer.slicer.head.head_draft:findSkin"


def findSkin(
    run: Run, volume: Any, settings: HeadSettings | None, progress: Progress
) -> tuple[HeadBody, HeadMesh, list[str]]:
    """Return the head in a `vtkMRMLScalarVolumeNode`, its skin, and warnings."""
    from rastrainer.slicer.head.volume import imageOfNode

    image, scene = imageOfNode(volume), volume.GetScene()

    def find(report: Progress) -> tuple[HeadBody, HeadMesh, list[str]]:
        found, skin, warnings = run(FIND_SKIN, report, image, settings)
        # Computed here rather than when the segment is shown.
        _ = found.labels
        return found, skin, warnings

    found = inBackground(find, progress)
    if volume.GetScene() is not scene:
        # In a cleared scene the next volume has the same ID, and would be taken for this one.
        raise InputError(_("The volume was removed before its head was found."))
    return found
