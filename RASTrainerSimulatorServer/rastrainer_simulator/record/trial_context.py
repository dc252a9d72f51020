"""The setup, versions, display and tutorial that are recorded with a trial."""

from __future__ import annotations

import contextlib
import platform
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

import rastrainer
from rastrainer.errors import InputError
from rastrainer.json_checks import number, numbers, one_of, text, whole_number
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import PROTOCOL_VERSION, Mode
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.core.setup import RecordedSetup, SimulationSetup, load_setup
from rastrainer_simulator.input.inputs import SourceKind

PACKAGES = ("numpy", "pin", "python-fcl")


def versions() -> dict[str, str]:
    """Return name and version of what a trajectory depends on; a missing package is left out."""
    return {
        "rastrainer": rastrainer.__version__,
        "protocol": str(PROTOCOL_VERSION),
        "python": platform.python_version(),
        "platform": f"{platform.system()} {platform.machine()}",
        **_OF_PACKAGES,
    }


# Looked up when imported: it reads folders, and a trial starts within a tick.
_OF_PACKAGES: dict[str, str] = {}
for _package in PACKAGES:
    with contextlib.suppress(metadata.PackageNotFoundError):
        _OF_PACKAGES[_package] = metadata.version(_package)


def setup_of(
    header: Mapping[str, Any], scenario_folder: Path | None = None, robot_meshes: Path | None = None
) -> SimulationSetup:
    """Return the setup that a journal's header describes."""
    recorded = record_from_json(RecordedSetup, header, "The journal's header")
    # A setting that is unknown here would be without effect.
    record_from_json(
        SimulationSettings, header["settings"], "The journal's settings", only_known=True
    )
    setup = load_setup(scenario_folder, recorded.settings, robot_meshes=robot_meshes)
    name, procedure = setup.scenario.name, recorded.procedure
    other = {
        "": "",
        "scenario": f"a scenario {recorded.scenario.name!r} whose files differ from those of "
        f"{name!r} here: give its folder with --scenario",
        "landmarks": f"other landmarks than those of {name!r} here: give its folder with "
        "--scenario",
        "procedure": f"a procedure {procedure.name if procedure else ''!r} that differs from that "
        f"of {name!r} here: give its folder with --scenario",
        "robot": f"another robot than {setup.robot.name} here",
    }[setup.difference(recorded)]
    if other:
        raise InputError(f"The trial was recorded with {other}.")
    return setup


GUIDED_TOUCHES = 3
LONGEST_S, MAX_MM = 1e6, 1e4
_Seconds = Annotated[float, number(0, LONGEST_S, "s")]
_Frames = Annotated[int, whole_number(0, 1_000_000)]
_Angle = Annotated[float, number(-360, 360, "degrees")]


@dataclass(frozen=True)
class TutorialOutcome:
    """A finished tutorial: its duration without menus, and the errors of the first touch and of
    the guided touches at the end."""

    trainee: str
    device: Annotated[str, one_of(*(kind.value for kind in SourceKind))]
    mode: Annotated[str, one_of(*(mode.value for mode in Mode))]
    duration_s: _Seconds
    first_error_mm: Annotated[float, number(0, MAX_MM, "mm")]
    errors_mm: Annotated[tuple[float, ...], numbers(GUIDED_TOUCHES, MAX_MM, "mm")]
    step_times_s: Mapping[str, _Seconds] = field(default_factory=dict)
    format_version: Annotated[int, whole_number(1, 1)] = 1


@dataclass(frozen=True)
class DisplayReport:
    """A view's report on the frames of the last second.

    `device` is the model of the headset or the name of the browser, "" if unknown; an unknown
    refresh rate is 0.
    """

    view: str  # "desktop", "page" or "headset"
    device: Annotated[str, text(80, 0)]
    refresh_hz: Annotated[float, number(0, 1e6, "Hz")]
    shown: _Frames
    dropped: _Frames


@dataclass(frozen=True)
class ViewReport:
    """A view, compared with the scenario's camera, and whether it has gone there automatically.

    `follows` is whether it goes to the best view of each next point, as set.
    """

    azimuth_deg: _Angle  # about the vertical, counterclockwise from above
    elevation_deg: _Angle
    zoom: Annotated[float, number(0, 1000)]
    is_automatic: bool
    follows: bool


@dataclass(frozen=True)
class GuidanceReport:
    """How the trainee is guided to the next point in this trial: "words", "arrow" or "none"."""

    guidance: str


@dataclass(frozen=True)
class GhostReport:
    """Which earlier trial is shown beside the arm in this trial: "own best" or "expert".

    Not by its UUID: a trainee who is deleted leaves no trace in others' journals.
    """

    ghost: str


NotedReport = DisplayReport | ViewReport | GuidanceReport | GhostReport | TutorialOutcome
"""Entries on how a trial is seen and prepared; the simulation does not depend on them."""
DRAWING_REPORTS: dict[str, type[DisplayReport | GuidanceReport | GhostReport]] = {
    "display": DisplayReport,
    "guidance": GuidanceReport,
    "ghost": GhostReport,
}
"""By their kind of entry, those that the trial's record sums up."""
_KINDS = {report: kind for kind, report in DRAWING_REPORTS.items()} | {
    ViewReport: "view",
    TutorialOutcome: "tutorial",
}


def report_entry(report: NotedReport) -> dict[str, Any]:
    """Return a report as the journal's entry, without its times."""
    values = record_to_json(report, with_defaults=True)
    # Those of a tutorial are in its own file.
    for name in ("trainee", "stepTimesS", "formatVersion"):
        values.pop(name, None)
    return {"kind": _KINDS[type(report)], **values}


@dataclass(frozen=True)
class PlayingSession:
    """The options with which the simulator was started.

    Attributes:
        speed: simulated seconds in a second; None is as fast as possible.
        is_seeded: whether the seeds of the heads' poses were chosen (`--seed`), not drawn.
    """

    speed: Annotated[float | None, number(0, 1e6)] = 1.0
    is_seeded: bool = False


REAL_TIME = PlayingSession()


class DisplayUse:
    """Adds up the reports of one trial."""

    def __init__(self) -> None:
        self._aids: dict[str, str | float] = {}
        self._last: DisplayReport | None = None
        self._shown = 0
        self._dropped = 0

    def add(self, report: NotedReport) -> None:
        """Add a report; those that are no matter of drawing are ignored."""
        if isinstance(report, DisplayReport):
            self._last = report
            self._shown += report.shown
            self._dropped += report.dropped
        elif isinstance(report, GuidanceReport | GhostReport):
            self._aids |= record_to_json(report, with_defaults=True)

    def summary(self) -> dict[str, str | float]:
        """Return `display` of the trial's record: the last view, all frames, and the aids."""
        aids = {name: aid for name in ("guidance", "ghost") if (aid := self._aids.get(name))}
        if self._last is None:
            return aids
        device = {"device": self._last.device} if self._last.device else {}
        return {
            "kind": self._last.view,
            **device,
            **aids,
            "refreshHz": self._last.refresh_hz,
            "shownFrames": self._shown,
            "droppedFrames": self._dropped,
        }
