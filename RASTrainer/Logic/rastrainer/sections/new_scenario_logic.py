"""Makes scenarios of volumes in the scene: the head is made here, and the simulator plans on it.

The head is shown first, to be accepted or changed. Fiducials and tasks need the robot, so the
simulator's program proposes them.
"""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rastrainer.errors import InputError
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.files.writing import write_json
from rastrainer.json_records import record_to_json
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario.points import touch_order
from rastrainer.scenario.scenario import UNKNOWN_LICENSE, Scenario
from rastrainer.scenario.setup import SetUp
from rastrainer.scenario.writer import HeadDraft, write_draft
from rastrainer.sections.scenario_files import ScenarioFiles, planArguments
from rastrainer.sections.scenario_logic import findSkin
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.polydata import meshPolyData
from rastrainer.slicer.program.child_process import Run, runChild
from rastrainer.slicer.scene import nodes
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress, no_progress

if TYPE_CHECKING:
    from rastrainer.slicer.head.volume import HeadSettings, SegmentImage

MAKE_DRAFT = "rastrainer.slicer.head.head_draft:makeDraft"
PREVIEWED_ATTRIBUTE = "RASTrainer.previewed"
SETTINGS_ATTRIBUTE = "RASTrainer.previewedWith"


@dataclass(frozen=True)
class NewScenarioOptions:
    """Options of a new scenario; the name of its volume stands in for empty texts.

    The volume is a T1-weighted MRI or CT of a head, the plan a list of points and a line from entry
    to target. `isHandPlaced` makes the scene's own point lists of 15 the tasks, in their order.
    """

    volume: Any
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

    @property
    def name(self) -> str:
        return self.title.strip() or self.volume.GetName()

    @property
    def headSettings(self) -> HeadSettings:
        from rastrainer.slicer.head.volume import HeadSettings

        return HeadSettings(threshold=self.threshold, baseMm=self.cutMm)


@dataclass(frozen=True)
class ScenarioMaker:
    """Shows the head in a volume, and makes a scenario of it.

    `progress` may raise to cancel: then nothing is left behind.
    """

    scene: Any
    files: ScenarioFiles
    run: Run

    def preview(self, options: NewScenarioOptions, progress: Progress) -> list[str]:
        """Show the head that is found, and return warnings, one sentence each.

        It is shown as a model, and as a segment that the Segment Editor may change; `make` then
        takes the segment as it is.
        """
        from rastrainer.slicer.head.volume import showSegment

        volume, settings = options.volume, options.headSettings
        found, skin, warnings = findSkin(self.run, volume, settings, progress)
        draft, model = Role.HEAD_SEGMENT.make(self.scene), Role.HEAD_PREVIEW.make(self.scene)
        showSegment(draft, found)
        draft.SetReferenceImageGeometryParameterFromVolumeNode(volume)
        draft.SetAttribute(PREVIEWED_ATTRIBUTE, volume.GetID())
        draft.SetAttribute(SETTINGS_ATTRIBUTE, repr(settings))
        model.SetAndObservePolyData(meshPolyData(skin))
        for node in (draft, model):
            # It is shown where it was found.
            node.SetAndObserveTransformNodeID(None)
            node.SetDisplayVisibility(True)
        return warnings

    def make(self, options: NewScenarioOptions, progress: Progress) -> tuple[Scenario, list[str]]:
        """Make a scenario, and return it with warnings."""
        warnings: list[str] = []
        scenario = self.files.add(
            options.name, lambda folder: warnings.extend(self._plan(options, progress, folder))
        )
        self._hidePreview(options.volume)
        return scenario, warnings

    def check(self, options: NewScenarioOptions, progress: Progress) -> list[str]:
        """Check set-up, plan and fiducials as `make` does, without making anything."""
        return self._plan(replace(options, hasSkull=False, hasVolume=False), progress)

    def _plan(
        self, options: NewScenarioOptions, progress: Progress, folder: Path | None = None
    ) -> list[str]:
        """Make a scenario in a folder, or only check its parts; return warnings."""
        from rastrainer.slicer.head.volume import imageOfNode

        volume, settings = options.volume, options.headSettings
        image, segment = imageOfNode(volume), editedHead(volume, settings)
        source = options.source.strip() or f"The volume {volume.GetName()} in 3D Slicer."
        terms = options.license.strip() or UNKNOWN_LICENSE
        words = [f"--title={options.name}", f"--source={source}", f"--license={terms}"]
        lists, leftOut = list[PointList](), list[str]()
        if options.isHandPlaced:
            lists, leftOut = handPlacedLists(self.scene, options.targets)

        def make(report: Progress) -> Any:
            kept = {"segment": segment, "hasVolume": options.hasVolume}
            return self.run(MAKE_DRAFT, report, image, settings, options.hasSkull, **kept)

        with tempfile.TemporaryDirectory() as temporary:
            setUp = Path(temporary, "setup.json")
            write_json(setUp, record_to_json(options.setUp, with_defaults=True))
            words += ["--setup", str(setUp), *planArguments(options.targets, options.trajectory)]
            tasks = [Path(temporary, f"task-{index}.mrk.json") for index in range(len(lists))]
            for path, points in zip(tasks, lists, strict=True):
                write_markups(path, points)
            words += ["--tasks", *map(str, tasks)] if tasks else []
            words += ["--check"] if folder is None else []
            command = self.files.simulator.command([])
            folder = folder or Path(temporary, "none")
            return [*leftOut, *planScenario(make, folder, words, command, progress)]

    def _hidePreview(self, volume: Any) -> None:
        """Hide the head as found, and a rendering of its volume: the result is shown instead."""
        for node in (*Role.HEAD_SEGMENT.all(self.scene), *Role.HEAD_PREVIEW.all(self.scene)):
            node.SetDisplayVisibility(False)
        for index in range(volume.GetNumberOfDisplayNodes()):
            display = volume.GetNthDisplayNode(index)
            if display is not None and display.IsA("vtkMRMLVolumeRenderingDisplayNode"):
                display.SetVisibility(False)


def editedHead(volume: Any, settings: HeadSettings) -> SegmentImage | None:
    """Return the segment of the head that is shown of a volume; None if none is."""
    from rastrainer.slicer.head.volume import SEGMENT_NAME, readSegment

    node = Role.HEAD_SEGMENT.find(volume.GetScene())
    if node is None or node.GetAttribute(PREVIEWED_ATTRIBUTE) != volume.GetID():
        return None
    if node.GetAttribute(SETTINGS_ATTRIBUTE) != repr(settings):
        problem = _(
            "The threshold or the cut has been changed since the head was found: find the head "
            "again, or reset it."
        )
        raise InputError(problem)
    return readSegment(node, node.GetSegmentation().GetSegmentIdBySegmentName(SEGMENT_NAME))


MAX_LISTS = 6


def handPlacedLists(scene: Any, targets: Any) -> tuple[list[PointList], list[str]]:
    """Return the points of the usable lists, in the scene's order, and why others are left out.

    The list of the planned `targets` has no fiducials.
    """
    taken, leftOut = list[PointList](), list[str]()
    for node in nodes.nodesOfClass(scene, "vtkMRMLMarkupsFiducialNode"):
        if node is targets or node.GetAttribute(nodes.ROLE_ATTRIBUTE) is not None:
            continue
        count = sum(nodes.isUsed(node, row) for row in range(node.GetNumberOfControlPoints()))
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
                used = nodes.usedPoints(node)
                touch_order(used.labels or [""] * len(used.points))
            except InputError as error:
                problem = _("The point list {name} cannot be used: {reason}")
                raise InputError(problem.format(name=node.GetName(), reason=error)) from None
            taken.append(used)
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

    `make` makes the head with its warnings, in a worker thread. `command` runs `rastrainer` of the
    simulator's Python; its `words` follow those that name `folder`, which is new or empty.
    """
    with tempfile.TemporaryDirectory() as temporary:

        def makeAndWrite(report: Progress) -> list[str]:
            draft, warnings = make(report)
            write_draft(Path(temporary), draft)
            return warnings

        def plan(step: str, share: float) -> None:
            progress(step, HEAD_SHARE + (1.0 - HEAD_SHARE) * share)

        head = inBackground(makeAndWrite, lambda step, share: progress(step, HEAD_SHARE * share))
        planner = [*command, "scenario", "tasks", temporary, "-o", str(folder), *words]
        ended = runChild(planner, plan, "Placing fiducials")
    if ended.exitStatus != 0:
        reason = ended.lastLine.removeprefix("rastrainer: ") or "it wrote nothing"
        raise InputError(f"The tasks could not be made: {reason}")
    return [*head, *ended.warnings]
