"""What a trial's journal notes of its display, view and aids, and of the tutorial before it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from rastrainer_simulator.record.tutorial_outcome import TutorialOutcome


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
