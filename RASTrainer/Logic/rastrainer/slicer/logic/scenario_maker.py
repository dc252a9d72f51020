"""Makes scenarios of volumes in the scene: the head is made here, and the simulator plans on it.

Fiducials and tasks need the robot, so the simulator's program proposes them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.files.point_files import write_markups
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario.points import touch_order
from rastrainer.scenario.scenario import UNKNOWN_LICENSE, Scenario, load_scenario
from rastrainer.scenario.setup import SetUp, write_setup
from rastrainer.scenario.writer import HeadDraft, write_draft
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.logic.head_preview import HeadPreview
from rastrainer.slicer.logic.scenario_cache import ScenarioCache
from rastrainer.slicer.logic.scenario_logic import planArguments
from rastrainer.slicer.logic.simulator_logic import SimulatorLogic
from rastrainer.slicer.program.child_process import Run, runChild
from rastrainer.slicer.scene.nodes import (
    ROLE_ATTRIBUTE,
    isUsed,
    labelsOf,
    nodesOfClass,
    usedPoints,
    worldPoints,
)
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress, no_progress

if TYPE_CHECKING:
    from rastrainer.slicer.head.volume import HeadSettings

MAKE_DRAFT = "rastrainer.slicer.head.head_draft:makeDraft"
SOURCE = "The volume {name} in 3D Slicer."


@dataclass(frozen=True)
class NewScenarioOptions:
    """Options of a new scenario besides its volume.

    Attributes:
        title: for people; empty takes the volume's name.
        source: where the images come from; empty names the volume.
        license: under which the scenario may be used; empty says that nothing is known.
        threshold: value that parts air from skin; None finds it.
        cutMm: height (S) of the flat base; None finds it.
        hasSkull: whether the skull is wanted.
        hasVolume: whether the scenario carries the images.
        setUp: how the head is placed before the robot.
        targets: a `vtkMRMLMarkupsFiducialNode` of planned targets, or None.
        trajectory: a `vtkMRMLMarkupsLineNode` from the entry to the target, or None.
        isHandPlaced: whether the scene's own point lists of 15 are the tasks, in their order.
    """

    title: str = ""
    source: str = ""
    license: str = ""
    threshold: float | None = None
    cutMm: float | None = None
    hasSkull: bool = True
    hasVolume: bool = True
    setUp: SetUp = field(default_factory=SetUp)
    targets: Any = None
    trajectory: Any = None
    isHandPlaced: bool = False


@dataclass(frozen=True)
class _Planned:
    """What the simulator should make.

    Attributes:
        title: of the scenario.
        head: makes the head; see `makeDraft`.
        words: arguments of `rastrainer scenario tasks`.
        warnings: what of the options is left out.
        folder: of their files.
    """

    title: str
    head: Callable[[Progress], tuple[Any, list[str]]]
    words: list[str]
    warnings: list[str]
    folder: Path


class ScenarioMaker:
    """What the panel New scenario does."""

    def __init__(
        self, scene: Any, simulator: SimulatorLogic, cache: ScenarioCache, library: Path, run: Run
    ) -> None:
        """Make scenarios.

        Args:
            simulator: whose program plans the tasks.
            cache: of the scenarios that there are.
            library: into which they come, each into a separate folder.
            run: runs the functions that find and make the head.
        """
        self._scene = scene
        self._simulator = simulator
        self._cache = cache
        self._library = library
        self._run = run
        self._preview = HeadPreview(scene, run)

    def preview(
        self, volumeNode: Any, options: NewScenarioOptions, progress: Progress
    ) -> list[str]:
        """Show the head that is found, and return warnings, one sentence each.

        The Segment Editor may change its segment; `make` then takes it as it is. Arguments are
        those of `make`.
        """
        return self._preview.show(_chosen(volumeNode), _settings(options), progress)

    def make(
        self, volumeNode: Any, options: NewScenarioOptions, progress: Progress
    ) -> tuple[Scenario, list[str]]:
        """Make a scenario in the library and return it with warnings, one sentence each.

        Args:
            volumeNode: T1-weighted MRI or CT of a head; the segment that `preview` has made of it
                is taken where there is one.
            options: what else is wanted.
            progress: called with each step and the share of the work done, many times a second; it
                may let the application draw, and may raise to cancel: then nothing is left behind.
        """
        with self._planned(volumeNode, options) as planned:
            folder = self._library / self._cache.newName(planned.title)
            command = self._simulator.command([])
            warnings = planScenario(planned.head, folder, planned.words, command, progress)
            scenario = load_scenario(folder)
        self._preview.hide(volumeNode)
        self._cache.refresh()
        return scenario, [*planned.warnings, *warnings]

    def check(self, volumeNode: Any, options: NewScenarioOptions, progress: Progress) -> list[str]:
        """Check whether set-up, plan and fiducials can be used, without making anything.

        Arguments, warnings and errors are those of `make`.
        """
        with self._planned(
            volumeNode, replace(options, hasSkull=False, hasVolume=False)
        ) as planned:
            command = self._simulator.command([])
            words = [*planned.words, "--check"]
            warnings = planScenario(planned.head, planned.folder / "none", words, command, progress)
        return [*planned.warnings, *warnings]

    @contextmanager
    def _planned(self, volumeNode: Any, options: NewScenarioOptions) -> Iterator[_Planned]:
        """Yield what the simulator should make; its files exist within the context."""
        from rastrainer.slicer.head.volume import imageOfNode

        image, settings = imageOfNode(_chosen(volumeNode)), _settings(options)
        segment = self._preview.segment(volumeNode, settings)
        title = options.title.strip() or volumeNode.GetName()
        source = options.source.strip() or SOURCE.format(name=volumeNode.GetName())
        terms = options.license.strip() or UNKNOWN_LICENSE
        words = [f"--title={title}", f"--source={source}", f"--license={terms}"]
        lists: list[Any] = []
        leftOut: list[str] = []
        if options.isHandPlaced:
            lists, leftOut = handPlacedLists(self._scene, options.targets)
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            yield _Planned(
                title,
                lambda report: self._run(
                    MAKE_DRAFT,
                    report,
                    image,
                    settings,
                    options.hasSkull,
                    segment=segment,
                    hasVolume=options.hasVolume,
                ),
                [*words, *self._words(options, folder), *_tasks(lists, folder)],
                leftOut,
                folder,
            )

    def _words(self, options: NewScenarioOptions, folder: Path) -> tuple[str, ...]:
        """Return the arguments of `rastrainer scenario tasks`; files go into `folder`."""
        setUp = folder / "setup.json"
        write_setup(setUp, options.setUp)
        words = ["--setup", str(setUp)]
        return (*words, *planArguments(options.targets, options.trajectory))


def _chosen(volumeNode: Any) -> Any:
    if volumeNode is None:
        raise InputError(_("Choose a volume first."))
    return volumeNode


def _settings(options: NewScenarioOptions) -> HeadSettings:
    from rastrainer.slicer.head.volume import HeadSettings

    return HeadSettings(threshold=options.threshold, baseMm=options.cutMm)


def _tasks(lists: list[Any], folder: Path) -> list[str]:
    """Return the arguments for manually placed fiducials, whose files go into `folder`."""
    paths = [folder / f"task-{index}.mrk.json" for index in range(len(lists))]
    for path, node in zip(paths, lists, strict=True):
        write_markups(path, usedPoints(node, worldPoints(node), labelsOf(node)))
    return ["--tasks", *map(str, paths)] if paths else []


MAX_LISTS = 6


def handPlacedLists(scene: Any, targets: Any) -> tuple[list[Any], list[str]]:
    """Return the usable lists, in the scene's order, and why others are left out.

    Args:
        targets: the list of the planned targets, which are no fiducials; None where there is none.
    """
    taken: list[Any] = []
    leftOut = []
    for node in nodesOfClass(scene, "vtkMRMLMarkupsFiducialNode"):
        if node is targets or node.GetAttribute(ROLE_ATTRIBUTE) is not None:
            continue
        count = sum(isUsed(node, row) for row in range(node.GetNumberOfControlPoints()))
        if count != FIDUCIAL_COUNT:
            reason = _(
                "The point list {name} is left out: it has {count} points that are placed and "
                "selected, not {all}."
            )
            leftOut.append(reason.format(name=node.GetName(), count=count, all=FIDUCIAL_COUNT))
        elif len(taken) == MAX_LISTS:
            reason = _("The point list {name} is left out: a scenario has at most {most} tasks.")
            leftOut.append(reason.format(name=node.GetName(), most=MAX_LISTS))
        else:
            taken.append(_checked(node))
    if not taken:
        problem = _("There is no point list of {count} fiducials in the scene.")
        raise InputError(" ".join([problem.format(count=FIDUCIAL_COUNT), *leftOut]))
    return taken, leftOut


def _checked(node: Any) -> Any:
    try:
        used = usedPoints(node, worldPoints(node), labelsOf(node))
        touch_order(used.labels or [""] * len(used.points))
    except InputError as error:
        raise InputError(
            _("The point list {name} cannot be used: {reason}").format(
                name=node.GetName(), reason=error
            )
        ) from None
    return node


HEAD_SHARE = 0.5
"""Share of the work on a scenario that finding and making its head takes."""


def planScenario(
    make: Callable[[Progress], tuple[HeadDraft, list[str]]],
    folder: Path,
    words: Sequence[str],
    command: Sequence[str],
    progress: Progress = no_progress,
) -> list[str]:
    """Make a head, have the simulator plan on it, and return warnings, one sentence each.

    Args:
        make: makes the head with its warnings, such as `makeDraft`, called in a worker thread.
        folder: to be made; must be new or empty.
        words: further arguments of `rastrainer scenario tasks`, such as `--title TITLE`; with
            `--check` nothing is made.
        command: words that run `rastrainer` of the simulator's Python.
        progress: called with each step's name and the share of the work done, many times a
            second; it may let the application draw, and may raise to cancel: nothing is left then.
    """
    with tempfile.TemporaryDirectory() as temporary:

        def makeAndWrite(report: Progress) -> list[str]:
            draft, warnings = make(report)
            write_draft(Path(temporary), draft)
            return warnings

        warnings = inBackground(
            makeAndWrite, lambda step, share: progress(step, HEAD_SHARE * share)
        )
        planner = [*command, "scenario", "tasks", temporary, "-o", str(folder), *words]
        return [*warnings, *_run(planner, progress)]


def _run(command: Sequence[str], progress: Progress) -> list[str]:
    """Run the planner of tasks to its end and return its warnings; `progress` may raise to stop."""

    def showShare(step: str, share: float) -> None:
        progress(step, HEAD_SHARE + (1.0 - HEAD_SHARE) * share)

    ended = runChild(command, showShare, "Placing fiducials")
    if ended.exitStatus != 0:
        reason = ended.lastLine.removeprefix("rastrainer: ") or "it wrote nothing"
        raise InputError(f"The tasks could not be made: {reason}")
    return list(ended.warnings)
