"""What was recorded of a trial's movement: samples of the tool and what happened meanwhile.

All times are the trial's own, in s from its start, pauses left out.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

NEAR_MM, FAR_MM = 20.0, 21.0
"""Clearances of the tip at which proximity begins and ends, unless the simulator is set otherwise;
a trial's journal tells its settings."""
TOUCHING_MM, RELEASED_MM = 0.05, 0.3
"""Clearances of the tool at which contact begins and ends, as above."""


@dataclass(frozen=True)
class Interval:
    """From when to when, in s, and how near to the head the tool was meanwhile, in mm.

    Attributes:
        start_s: the trial's time.
        end_s: the trial's time.
        least_clearance_mm: least signed distance of tool and head.
        greatest_depth_mm: how far the commanded motion has gone into the head at most.
    """

    start_s: float
    end_s: float
    least_clearance_mm: float = np.inf
    greatest_depth_mm: float = 0.0

    @property
    def duration_s(self) -> float:
        """How long it lasted."""
        return self.end_s - self.start_s


@dataclass(frozen=True)
class Touch:
    """A touch: which fiducial was due, where the tip was (World, mm) and when."""

    label: str
    position_mm: tuple[float, float, float]
    time_s: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The movement of one trial.

    Attributes:
        times_s: (n,) float, strictly rising.
        tip_mm: (n, 3) float, the tool's tip, World.
        clearance_mm: (n,) float, signed distance of the tool to the head.
        touches: the kept ones, in their order.
        refused: touches that did not count.
        undone: how many touches were taken back.
        near: when the tip was near the head, or the tool touched it.
        contacts: when it touched the head.
        camera_switches: how often the view was changed.
        pauses: how often the trial was paused.
        paused_s: how long in all.
        fiducials_mm: label → (3,) position in World; empty as long as that is a secret.
        shortest_path_mm: the shortest free way through the task's fiducials; None where unknown.
        depth_mm: (n,) float, how far the commanded motion has gone into the head beyond where the
            tool could go; None where it was not recorded for the whole trial.
    """

    times_s: np.ndarray
    tip_mm: np.ndarray
    clearance_mm: np.ndarray
    touches: tuple[Touch, ...]
    refused: tuple[Touch, ...] = ()
    undone: int = 0
    near: tuple[Interval, ...] = ()
    contacts: tuple[Interval, ...] = ()
    camera_switches: int = 0
    pauses: int = 0
    paused_s: float = 0.0
    fiducials_mm: Mapping[str, np.ndarray] = field(default_factory=dict)
    shortest_path_mm: float | None = None
    depth_mm: np.ndarray | None = None

    @property
    def touch_times_s(self) -> np.ndarray:
        """Times of the kept touches, (m,) float."""
        return np.array([touch.time_s for touch in self.touches])

    @property
    def touch_positions_mm(self) -> np.ndarray:
        """Positions of the kept touches, (m, 3) float, World."""
        return np.array([touch.position_mm for touch in self.touches], dtype=float).reshape(-1, 3)
