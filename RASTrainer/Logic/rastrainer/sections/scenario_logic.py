"""Scenarios: in the scene, as files, plans saved in them, and methods of registration on them."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.scenario.library import unpack
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.sections.scenario_cache import ScenarioCache
from rastrainer.sections.simulator_logic import SimulatorLogic
from rastrainer.slicer.background_work import BackgroundWork, inBackground
from rastrainer.slicer.polydata import meshPolyData
from rastrainer.slicer.program.child_process import Run
from rastrainer.slicer.scene.nodes import (
    ROLE_ATTRIBUTE,
    Role,
    capturedPointsNode,
    findNode,
    labelsOf,
    worldPoints,
)
from rastrainer.slicer.scene.robot import addLink, missingLinks, robotNode, setRobotVisible
from rastrainer.slicer.scene.robot_description import READ_LINKS, LinkMesh
from rastrainer.slicer.scene.scenario_nodes import (
    SKIN_COLOR,
    showImages,
    showScenario,
    showTask,
)
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


class ScenarioLogic:
    """Shows scenarios, other heads and the robot in the scene.

    Attributes:
        robotShown: emits nothing when the whole robot is in the scene.
        problemFound: emits a sentence if the robot's files cannot be used.
    """

    def __init__(
        self, scene: Any, cache: ScenarioCache, robotFolder: Path, run: Run, work: BackgroundWork
    ) -> None:
        """`run` runs the functions that look for heads and read the robot, the latter in `work`."""
        self.robotShown = Signal()
        self.problemFound = Signal()
        self._scene = scene
        self._cache = cache
        self._robotFolder = robotFolder
        self._run = run
        self._work = work
        self._links: tuple[LinkMesh, ...] = ()
        self._isRobotComing = False

    def show(
        self, scenarioName: str, taskName: str, then: Callable[[], None] = lambda: None
    ) -> None:
        """Show a scenario's head and a task's fiducials in the next turns; then call `then`."""
        scenario, later = self._cache.find(scenarioName), self._work.changeScene
        scenario.task(taskName)  # Raises before anything is shown.
        showScenario(self._scene, scenario, later)
        later(partial(showImages, self._scene))
        later(partial(showTask, self._scene, scenario, taskName))
        later(partial(showOnlyTouchesOf, self._scene, scenario.name, taskName))
        later(partial(self._showPlace, scenario, taskName))
        later(then)

    def _showPlace(self, scenario: Scenario, taskName: str) -> None:
        fixed = showTask(self._scene, scenario, taskName)
        placed = findNode(self._scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
        if placed is None or placed.GetAttribute(KIND_ATTRIBUTE) == PLANNED:
            showPlannedPlace(self._scene, scenario, capturedPointsNode(self._scene), fixed)

    def useHead(self, node: Any, progress: Progress = no_progress) -> tuple[Any, list[str]]:
        """Make a model, or the skin of a volume, the displayed head; return it with warnings.

        The head that was one before is hidden, and is no longer ours to fill.
        """
        model, warnings = node, list[str]()
        if node.IsA("vtkMRMLVolumeNode"):
            _body, mesh, warnings = findSkin(self._run, node, None, progress)
            name = f"Head of {node.GetName()}"
            model = self._scene.AddNewNodeByClass("vtkMRMLModelNode", name)
            model.SetAndObservePolyData(meshPolyData(mesh))
            model.CreateDefaultDisplayNodes()
            model.GetDisplayNode().SetColor(SKIN_COLOR)
        former = findNode(self._scene, "vtkMRMLModelNode", Role.HEAD_MODEL)
        if former is not None and former is not model:
            former.RemoveAttribute(ROLE_ATTRIBUTE)
            former.SetDisplayVisibility(False)
        model.SetAttribute(ROLE_ATTRIBUTE, Role.HEAD_MODEL)
        model.CreateDefaultDisplayNodes()
        model.SetDisplayVisibility(True)
        return model, warnings

    def setRobotShown(self, shown: bool) -> None:
        """Show the robot, which follows the link, or hide it; its links come one by one."""

        def refuse(error: Exception) -> None:
            self._isRobotComing = False
            self.problemFound.emit(_("The robot cannot be shown. {problem}").format(problem=error))

        setRobotVisible(self._scene, shown)
        self._isRobotComing = shown
        if shown and (self._links or not missingLinks(self._scene)):
            self._addLinks(self._links)
        elif shown:
            check, folder = self._work.checkWanted, self._robotFolder
            self._work.do(lambda: self._run(READ_LINKS, check, folder), self._addLinks, refuse)

    def forgetScene(self) -> None:
        self._isRobotComing = False

    @property
    def isRobotShown(self) -> bool:
        node = robotNode(self._scene, 0)
        return self._isRobotComing or (node is not None and bool(node.GetDisplayVisibility()))

    def _addLinks(self, links: tuple[LinkMesh, ...]) -> None:
        """Add the links that are missing, one in each turn."""
        self._links = links

        def addMissing(number: int) -> None:
            if self._isRobotComing and number in missingLinks(self._scene):
                addLink(self._scene, number, links[number])
                # At once, so that the views can be moved to it.
                followPlacement(self._scene)

        def finish() -> None:
            if self._isRobotComing:
                self._isRobotComing = False
                self.robotShown.emit()

        for number in missingLinks(self._scene):
            self._work.later(partial(addMissing, number))
        self._work.later(finish)


class ScenarioFiles:
    """Scenarios on disk, which the simulator's program writes.

    `progress` is called while it works: it may let the application draw, and may raise to cancel.
    """

    def __init__(self, simulator: SimulatorLogic, cache: ScenarioCache, library: Path) -> None:
        """Scenarios come into the folder `library`, each into a separate folder."""
        self.simulator = simulator
        self._cache = cache
        self._library = library

    def add(self, title: str, make: Callable[[Path], object]) -> Scenario:
        """Return the scenario that `make` makes in the folder it is given."""
        folder = self._library / self._cache.newName(title)
        make(folder)
        self._cache.refresh()
        return load_scenario(folder)

    def importScenario(self, package: Path, progress: Progress = no_progress) -> Scenario:
        folder = inBackground(lambda report: unpack(package, self._library, report), progress)
        self._cache.refresh()
        return load_scenario(folder)

    def drawFaceRemoval(self, name: str, picture: Path, progress: Progress = no_progress) -> str:
        """Draw a head before and after its face is removed; return a sentence on the picture."""
        folder = str(self._cache.find(name).folder)
        words = ["pack", folder, os.devnull, "--picture", str(picture)]
        return self.run(words, progress)

    def exportScenario(
        self,
        name: str,
        package: Path,
        keepsFace: bool = False,
        keepsNames: bool = False,
        progress: Progress = no_progress,
    ) -> str:
        """Write a scenario as a zip file; return a sentence about removed parts.

        Args:
            keepsFace: whether the head keeps its face and skull; otherwise the user has seen what
                `drawFaceRemoval` has drawn.
            keepsNames: whether title, name and source stay, which may be the patient's name.
        """
        words = ["pack", str(self._cache.find(name).folder), str(package)]
        words += ["--keep-face"] if keepsFace else ["--yes"]
        words += ["--keep-names"] if keepsNames else []
        return self.run(words, progress)

    def saveWith(
        self, plan: list[str], name: str, title: str, progress: Progress = no_progress
    ) -> Scenario:
        """Copy a scenario with a part replaced, and return the copy.

        `plan` are arguments of `rastrainer scenario plan`, such as `--landmarks` with a file.
        """
        source, words = str(self._cache.find(name).folder), [f"--title={title}", *plan]
        return self.add(
            title, lambda folder: self.run(["plan", source, "-o", str(folder), *words], progress)
        )

    def run(self, words: list[str], progress: Progress, mayFail: bool = False) -> str:
        """Run `rastrainer scenario`; see `SimulatorLogic.run`."""
        return self.simulator.run(["scenario", *words], progress, mayFail)


def planArguments(*planned: Any | None) -> list[str]:
    """Return the arguments of `rastrainer scenario` for lists of targets, and a line."""
    words = []
    for node in planned:
        if node is None:
            continue
        points = worldPoints(node)
        if not node.IsA("vtkMRMLMarkupsLineNode"):
            for name, place in zip(labelsOf(node), points, strict=True):
                words += ["--target", name, *map(str, place.tolist())]
        elif len(points) == 2:
            words += ["--trajectory", node.GetName(), *map(str, points.ravel().tolist())]
        else:
            raise InputError(_("The trajectory needs two points: its entry and its target."))
    return words


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


LIMIT_BYTES = 1 << 20


@dataclass(frozen=True)
class ComparedMethod:
    """How a method has registered the trials; lengths in mm, root mean squares over trials.

    Attributes:
        low, high: medians of the ends of the 95 % interval of the target error.
        residual: of the points that count; it does not show the error.
        held: share of the intervals that hold the true error.
    """

    name: str
    low: float
    high: float
    residual: float
    expected: float
    true: float
    held: float


KEYS = ("residual_mm", "expected_tre_mm", "true_tre_mm", "interval_holds_share")
"""Keys of the last four fields above, in the program's output."""


def compareMethods(
    simulator: SimulatorLogic,
    scenario: Scenario,
    trials: int,
    skinShiftMm: float,
    progress: Progress = no_progress,
) -> list[ComparedMethod]:
    """Return how each method for which a head has the points registers simulated trials.

    `skinShiftMm` is the RMS shift between imaging and operation.
    """
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "methods"
        words = ["compare-methods", "--scenario", str(scenario.folder), "-o", str(folder)]
        words += ["--trials", str(trials), "--skin-shift", str(skinShiftMm)]
        simulator.run(words, progress)
        compared = read_json(folder / "methods.json", LIMIT_BYTES)
    try:
        return [
            ComparedMethod(name, *map(float, [*values["interval_mm"], *map(values.get, KEYS)]))
            for name, values in compared["methods"].items()
        ]
    except (KeyError, TypeError, ValueError, AttributeError):
        raise InputError(_("The simulator's program has a different version.")) from None
