"""What is recorded beside a trial: its setup and versions, its display, the tutorial before it."""

from __future__ import annotations

import contextlib
import platform
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from importlib import metadata
from pathlib import Path
from types import MappingProxyType
from typing import Any

import rastrainer
from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields
from rastrainer.protocol import PROTOCOL_VERSION, Mode, TouchRule
from rastrainer_simulator.core.settings import SimulationSettings, settings_from_json
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
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


def _of_packages() -> Mapping[str, str]:
    found = {}
    for package in PACKAGES:
        with contextlib.suppress(metadata.PackageNotFoundError):
            found[package] = metadata.version(package)
    return MappingProxyType(found)


# Looked up when imported: it reads folders, and a trial starts within a tick.
_OF_PACKAGES = _of_packages()


def setup_of(
    header: Mapping[str, Any], scenario_folder: Path | None = None, robot_meshes: Path | None = None
) -> SimulationSetup:
    """Return the setup that a journal's header describes."""
    try:
        settings = settings_from_json(SimulationSettings, _with_touch_rule(header["settings"]))
        name, sha256 = header["scenario"]["name"], header["scenario"]["sha256"]
    except (KeyError, TypeError, AttributeError):
        raise InputError("The journal's header lacks the scenario or the settings.") from None
    setup = load_setup(scenario_folder, settings, robot_meshes=robot_meshes)
    if not setup.is_of(sha256):
        raise InputError(
            f"The trial was recorded with a scenario {name!r} whose files differ from those of "
            f"{setup.scenario.name!r} here: give its folder with --scenario."
        )
    try:
        is_same_procedure = setup.matches_procedure(header)
        has_same_landmarks = setup.matches_landmarks(header)
    except (KeyError, TypeError, AttributeError):
        raise InputError(
            "The journal's header does not name its procedure or method as it should."
        ) from None
    if not has_same_landmarks:
        raise InputError(
            f"The trial was recorded with other landmarks than those of {setup.scenario.name!r} "
            "here: give its folder with --scenario."
        )
    if not is_same_procedure:
        raise InputError(
            f"The trial was recorded with a procedure {header['procedure']['name']!r} that differs "
            f"from that of {setup.scenario.name!r} here: give its folder with --scenario."
        )
    if setup.robot.name != header.get("robot"):
        raise InputError(f"The trial was recorded with another robot than {setup.robot.name} here.")
    return setup


def _with_touch_rule(settings: Mapping[str, Any]) -> dict[str, Any]:
    rule = {"touch_rule": TouchRule.WITHIN_RADIUS.value}
    return {**settings, "training": {**rule, **settings.get("training", {})}}


GUIDED_TOUCHES = 3
FORMAT_VERSION = 1
TUTORIAL_DECIMALS = 3
LONGEST_S, MAX_MM = 1e6, 1e4


@dataclass(frozen=True)
class TutorialOutcome:
    """A finished tutorial.

    Attributes:
        trainee: pseudonym.
        device: value of the `SourceKind` that the arm was driven with.
        mode: "desktop" or "hmd".
        seconds: how long it took, menus excluded.
        first_error_mm: of the first touch.
        errors_mm: of the guided touches at the end.
        step_seconds: the same as `seconds` for each step, by name.
    """

    trainee: str
    device: str
    mode: str
    seconds: float
    first_error_mm: float
    errors_mm: tuple[float, ...]
    step_seconds: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def of(cls, fields: Fields) -> TutorialOutcome:
        """Return the tutorial that a file holds."""
        if fields.number("formatVersion", 0, 1e9) != FORMAT_VERSION:
            raise InputError(f"The tutorial's formatVersion must be {FORMAT_VERSION}.")
        steps = fields.fields("stepSeconds")
        return cls(
            trainee=fields.text("trainee", 64),
            device=fields.one_of("device", tuple(kind.value for kind in SourceKind)),
            mode=fields.one_of("mode", tuple(mode.value for mode in Mode)),
            seconds=fields.number("seconds", 0, LONGEST_S),
            first_error_mm=fields.number("firstErrorMm", 0, MAX_MM),
            errors_mm=tuple(fields.numbers("errorsMm", GUIDED_TOUCHES, MAX_MM)),
            step_seconds={step: steps.number(step, 0, LONGEST_S) for step in steps.names()},
        )

    def to_json(self) -> dict[str, Any]:
        """Return the JSON object that `of` reads."""
        steps = {
            step: round(seconds, TUTORIAL_DECIMALS) for step, seconds in self.step_seconds.items()
        }
        return {
            "formatVersion": FORMAT_VERSION,
            "trainee": self.trainee,
            "device": self.device,
            "mode": self.mode,
            "seconds": round(self.seconds, TUTORIAL_DECIMALS),
            "firstErrorMm": round(self.first_error_mm, TUTORIAL_DECIMALS),
            "errorsMm": [round(error, TUTORIAL_DECIMALS) for error in self.errors_mm],
            "stepSeconds": steps,
        }

    def entry(self) -> dict[str, Any]:
        """Return what goes into the journal of a trial run, without its times."""
        kept = ("device", "mode", "seconds", "firstErrorMm", "errorsMm")
        values = self.to_json()
        return {"kind": "tutorial", **{name: values[name] for name in kept}}


@dataclass(frozen=True)
class DisplayReport:
    """A view's report on the last second.

    Attributes:
        view: "desktop", "page" or "headset".
        device: model of the headset or name of the browser; "" where unknown.
        refresh_hz: of the display; 0 where unknown.
        shown: frames shown.
        dropped: frames dropped.
    """

    view: str
    device: str
    refresh_hz: float
    shown: int
    dropped: int

    @classmethod
    def of(cls, entry: Mapping[str, Any]) -> DisplayReport:
        named = (entry[name] for name in ("view", "device", "refreshHz", "shown", "dropped"))
        return cls(*named)

    def entry(self) -> dict[str, Any]:
        """Return the journal's entry, without its times."""
        values = asdict(self)
        values["refreshHz"] = values.pop("refresh_hz")
        return {"kind": "display", **values}


class DisplayUse:
    """Adds up the reports of one trial.

    Attributes:
        guidance: how the trainee is guided to the next point; "" where no screen shows it.
        ghost: which earlier trial was shown beside the arm; "" for none.
    """

    def __init__(self) -> None:
        self.guidance = self.ghost = ""
        self._last: DisplayReport | None = None
        self._shown = 0
        self._dropped = 0

    def add(self, report: DisplayReport) -> None:
        self._last = report
        self._shown += report.shown
        self._dropped += report.dropped

    def summary(self) -> dict[str, str | float]:
        """Return `display` of the trial's record: the last view, all frames, and the aids."""
        aids = {"guidance": self.guidance, "ghost": self.ghost}
        shown = {name: aid for name, aid in aids.items() if aid}
        if self._last is None:
            return {**shown}
        device = {"device": self._last.device} if self._last.device else {}
        return {
            "kind": self._last.view,
            **device,
            **shown,
            "refreshHz": self._last.refresh_hz,
            "shownFrames": self._shown,
            "droppedFrames": self._dropped,
        }


DECIMALS = 2


@dataclass(frozen=True)
class ViewReport:
    """A view, compared with the scenario's camera.

    Attributes:
        azimuth_deg: turn about the vertical, counterclockwise from above.
        elevation_deg: how much higher it is.
        zoom: its distance, as a share.
        is_automatic: whether it has gone there automatically.
        follows: whether it goes automatically to the best view of each next point, as set.
    """

    azimuth_deg: float
    elevation_deg: float
    zoom: float
    is_automatic: bool
    follows: bool

    def entry(self) -> dict[str, Any]:
        """Return what goes into the journal, without its times."""
        return {
            "kind": "view",
            "azimuthDeg": round(self.azimuth_deg, DECIMALS),
            "elevationDeg": round(self.elevation_deg, DECIMALS),
            "zoom": round(self.zoom, DECIMALS),
            "isAutomatic": self.is_automatic,
            "follows": self.follows,
        }


@dataclass(frozen=True)
class GuidanceReport:
    """How the trainee is guided to the next point in this trial: "words", "arrow" or "none"."""

    guidance: str

    def entry(self) -> dict[str, Any]:
        """Return what goes into the journal, without its times."""
        return {"kind": "guidance", "guidance": self.guidance}


@dataclass(frozen=True)
class GhostReport:
    """Which earlier trial is shown beside the arm in this trial: "own best" or "expert".

    Not by its UUID: a trainee who is deleted leaves no trace in others' journals.
    """

    ghost: str

    def entry(self) -> dict[str, Any]:
        """Return what goes into the journal, without its times."""
        return {"kind": "ghost", "ghost": self.ghost}


@dataclass(frozen=True)
class PlayingSession:
    """What a simulator that plays trials was started with.

    Attributes:
        speed: simulated seconds in a second; None is as fast as possible.
        is_seeded: whether the seeds of the heads' poses were chosen (`--seed`), not drawn.
    """

    speed: float | None = 1.0
    is_seeded: bool = False

    def to_json(self) -> dict[str, Any]:
        """Return what goes into a journal."""
        return {"speed": self.speed, "isSeeded": self.is_seeded}


REAL_TIME = PlayingSession()


NotedReport = DisplayReport | ViewReport | GuidanceReport | GhostReport | TutorialOutcome
"""Entries on how a trial is seen and prepared; the simulation does not depend on them."""
