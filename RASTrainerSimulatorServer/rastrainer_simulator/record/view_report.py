"""How the trainee's view is turned during a trial, and how it is guided, for its journal."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from rastrainer_simulator.record.display_use import DisplayReport

DECIMALS = 2


@dataclass(frozen=True)
class ViewReport:
    """A view, compared with the scenario's camera.

    Attributes:
        azimuth_deg: turn about the vertical, counterclockwise from above.
        elevation_deg: how much higher it is.
        zoom: its distance, as a share.
        is_automatic: whether it has gone there by itself.
        follows: whether it goes to the best view of each next point by itself, as is set.
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


NotedReport = DisplayReport | ViewReport | GuidanceReport
"""What is noted of how a trial is seen; the simulation does not depend on it."""
