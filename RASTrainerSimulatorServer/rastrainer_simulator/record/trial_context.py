"""What is recorded beside a trial: how it is seen, and the tutorial that came before it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields
from rastrainer.protocol import Mode
from rastrainer_simulator.input.inputs import SourceKind

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
        """Return the tutorial that a file holds.

        Raises:
            InputError: a field is wrong.
        """
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
        """Return the report of an entry, as made by `entry`."""
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
        """Add a report."""
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


NotedReport = DisplayReport | ViewReport | GuidanceReport | GhostReport | TutorialOutcome
"""What is noted of how a trial is seen and prepared; the simulation does not depend on it."""
