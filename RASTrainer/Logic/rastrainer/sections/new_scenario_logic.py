"""Makes scenarios of volumes in the scene: the head is made here, and the simulator plans on it.

Fiducials and tasks need the robot, so the simulator's program proposes them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.files.point_files import write_markups
from rastrainer.files.writing import write_json
from rastrainer.json_records import record_to_json
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario.points import touch_order
from rastrainer.scenario.scenario import UNKNOWN_LICENSE, Scenario
from rastrainer.scenario.setup import SetUp
from rastrainer.scenario.writer import HeadDraft, write_draft
from rastrainer.sections.head_preview import editedHead, hideHead, showHead
from rastrainer.sections.scenario_logic import ScenarioFiles, planArguments
from rastrainer.slicer.background_work import inBackground
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
    """Options of a new scenario besides its volume, which stands in for empty texts.

    Attributes:
        threshold: value that parts air from skin; None finds it.
        cutMm: height (S) of the flat base; None finds it.
        hasVolume: whether the scenario carries the images.
        targets: a `vtkMRMLMarkupsFiducialNode`, or None.
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


class ScenarioMaker:
    """What the panel New scenario does."""

    def __init__(self, scene: Any, files: ScenarioFiles, run: Run) -> None:
        self._scene = scene
        self._files = files
        self._run = run

    def preview(
        self, volumeNode: Any, options: NewScenarioOptions, progress: Progress
    ) -> list[str]:
        """Show the head that is found, and return warnings, one sentence each.

        The Segment Editor may change its segment; `make` then takes it as it is.
        """
        return showHead(self._run, volumeNode, _settings(options), progress)

    def make(
        self, volumeNode: Any, options: NewScenarioOptions, progress: Progress
    ) -> tuple[Scenario, list[str]]:
        """Make a scenario of a T1-weighted MRI or CT of a head, and return it with warnings.

        `progress` may raise to cancel: then nothing is left behind.
        """
        title = options.title.strip() or volumeNode.GetName()
        warnings: list[str] = []
        scenario = self._files.add(
            title,
            lambda folder: warnings.extend(self._plan(volumeNode, options, progress, folder)),
        )
        hideHead(self._scene, volumeNode)
        return scenario, warnings

    def check(self, volumeNode: Any, options: NewScenarioOptions, progress: Progress) -> list[str]:
        """Check set-up, plan and fiducials as `make` does, without making anything."""
        options = replace(options, hasSkull=False, hasVolume=False)
        return self._plan(volumeNode, options, progress)

    def _plan(
        self,
        volumeNode: Any,
        options: NewScenarioOptions,
        progress: Progress,
        folder: Path | None = None,
    ) -> list[str]:
        """Make a scenario in a folder, or only check what it is to be made of; return warnings."""
        from rastrainer.slicer.head.volume import imageOfNode

        image, settings = imageOfNode(volumeNode), _settings(options)
        segment = editedHead(volumeNode, settings)
        title = options.title.strip() or volumeNode.GetName()
        source = options.source.strip() or SOURCE.format(name=volumeNode.GetName())
        terms = options.license.strip() or UNKNOWN_LICENSE
        words = [f"--title={title}", f"--source={source}", f"--license={terms}"]
        lists, leftOut = list[Any](), list[str]()
        if options.isHandPlaced:
            lists, leftOut = handPlacedLists(self._scene, options.targets)

        def make(report: Progress) -> tuple[HeadDraft, list[str]]:
            made: tuple[HeadDraft, list[str]] = self._run(
                MAKE_DRAFT,
                report,
                image,
                settings,
                options.hasSkull,
                segment=segment,
                hasVolume=options.hasVolume,
            )
            return made

        with tempfile.TemporaryDirectory() as temporary:
            setUp = Path(temporary, "setup.json")
            write_json(setUp, record_to_json(options.setUp, with_defaults=True))
            words += ["--setup", str(setUp), *planArguments(options.targets, options.trajectory)]
            tasks = [Path(temporary, f"task-{index}.mrk.json") for index in range(len(lists))]
            for path, node in zip(tasks, lists, strict=True):
                write_markups(path, usedPoints(node, worldPoints(node), labelsOf(node)))
            words += ["--tasks", *map(str, tasks)] if tasks else []
            words += ["--check"] if folder is None else []
            command = self._files.simulator.command([])
            folder = folder or Path(temporary, "none")
            return [*leftOut, *planScenario(make, folder, words, command, progress)]


def _settings(options: NewScenarioOptions) -> HeadSettings:
    from rastrainer.slicer.head.volume import HeadSettings

    return HeadSettings(threshold=options.threshold, baseMm=options.cutMm)


MAX_LISTS = 6


def handPlacedLists(scene: Any, targets: Any) -> tuple[list[Any], list[str]]:
    """Return the usable lists, in the scene's order, and why others are left out.

    The list of the planned `targets` has no fiducials.
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
            try:
                used = usedPoints(node, worldPoints(node), labelsOf(node))
                touch_order(used.labels or [""] * len(used.points))
            except InputError as error:
                problem = _("The point list {name} cannot be used: {reason}")
                raise InputError(problem.format(name=node.GetName(), reason=error)) from None
            taken.append(node)
    if not taken:
        problem = _("There is no point list of {count} fiducials in the scene.")
        raise InputError(" ".join([problem.format(count=FIDUCIAL_COUNT), *leftOut]))
    return taken, leftOut


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
        make: makes the head with its warnings, in a worker thread.
        folder: to be made; must be new or empty.
        words: further arguments of `rastrainer scenario tasks`.
        command: runs `rastrainer` of the simulator's Python.
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
        ended = runChild(
            planner,
            lambda step, share: progress(step, HEAD_SHARE + (1.0 - HEAD_SHARE) * share),
            "Placing fiducials",
        )
    if ended.exitStatus != 0:
        reason = ended.lastLine.removeprefix("rastrainer: ") or "it wrote nothing"
        raise InputError(f"The tasks could not be made: {reason}")
    return [*warnings, *ended.warnings]
