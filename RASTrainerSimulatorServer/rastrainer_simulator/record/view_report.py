"""What a trial's journal notes of its view, its aids, and the tutorial before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rastrainer_simulator.record.display_use import DisplayReport
from rastrainer_simulator.record.tutorial_outcome import TutorialOutcome

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
