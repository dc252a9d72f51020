"""The recorded movement of a trial: samples of the tool, touches, contacts and other events.

All times are the trial's own, in s from its start, excluding pauses.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

NEAR_MM, FAR_MM = 20.0, 21.0
"""Clearances of the tip at which proximity starts and ends by default; the journal has the actual
settings."""
TOUCHING_MM, RELEASED_MM = 0.05, 0.3
"""Clearances of the tool at which contact starts and ends by default."""


@dataclass(frozen=True)
class Interval:
    """A time interval and the tool's distance to the head in it.

    Attributes:
        start_s: trial time.
        end_s: trial time.
        least_clearance_mm: smallest signed distance of tool and head.
        greatest_depth_mm: how far the commanded motion went into the head at most.
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
    """A touch: the fiducial due, the position of the tip (World, mm) and the time.

    A point of a trace is one without a label.
    """

    label: str
    position_mm: tuple[float, float, float]
    time_s: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The movement of one trial.

    Attributes:
        times_s: (n,) float, strictly increasing.
        tip_mm: (n, 3) float, the tool's tip, World.
        clearance_mm: (n,) float, signed distance of the tool to the head.
        touches: kept touches, in order.
        refused: refused touches.
        traced: kept points of a trace, in order.
        undone: number of undone touches.
        near: intervals with the tip near the head, or the tool in contact.
        contacts: intervals in contact.
        camera_switches: number of changes of the view.
        pauses: number of pauses.
        paused_s: their total duration.
        fiducials_mm: label → (3,) position in World; empty while secret.
        shortest_path_mm: the shortest free path through the task's fiducials, or None.
        depth_mm: (n,) float, how far the commanded motion went into the head beyond the tool; None
            unless recorded for the whole trial.
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
    traced: tuple[Touch, ...] = ()

    @property
    def intended(self) -> tuple[Touch, ...]:
        """Where contact is intended: the kept touches and the points of the trace, by time."""
        if not self.traced:
            return self.touches
        return tuple(sorted((*self.touches, *self.traced), key=lambda touch: touch.time_s))

    @property
    def touch_times_s(self) -> np.ndarray:
        """Times of the kept touches, (m,) float."""
        return np.array([touch.time_s for touch in self.touches])

    @property
    def touch_positions_mm(self) -> np.ndarray:
        """Positions of the kept touches, (m, 3) float, World."""
        return np.array([touch.position_mm for touch in self.touches], dtype=float).reshape(-1, 3)


INTENDED_MM = 5.0
"""Contact with the tip within this distance of a touch is intended."""


def unintended_contact(trajectory: Trajectory) -> tuple[float, float]:
    """Return the time (s) of unintended contact and the path (mm) of the tip during it.

    Contact is unintended while the tip is farther than `INTENDED_MM` from both the next and the
    previous kept touch or traced point; without any, always. The tip is interpolated linearly
    between samples. Between neighboring samples or touches the midpoint decides, for the part of
    the time in contact. Repeated contact cannot lower the result.
    """
    contacts, samples_s = trajectory.contacts, trajectory.times_s
    if not contacts or not len(samples_s):
        return float(sum(contact.duration_s for contact in contacts)), 0.0
    # Before the first sample and after the last the tip is where that one has it.
    ends = [min(c.start_s for c in contacts), max(c.end_s for c in contacts)]
    outer = [time for time in ends if not samples_s[0] <= time <= samples_s[-1]]
    times = np.unique(np.concatenate([samples_s, trajectory.touch_times_s, outer]))
    tip = np.column_stack([np.interp(times, samples_s, axis) for axis in trajectory.tip_mm.T])
    starts, steps = times[:-1], np.diff(times)
    middle = (tip[:-1] + tip[1:]) / 2
    counts = _distance_to_touches(trajectory.intended, starts + steps / 2, middle) > INTENDED_MM
    in_contact = np.zeros(len(steps))
    for contact in contacts:
        in_contact += np.clip(contact.end_s, starts, times[1:]) - np.clip(
            contact.start_s, starts, times[1:]
        )
    speeds = np.linalg.norm(np.diff(tip, axis=0), axis=1) / steps
    time_s = in_contact * counts
    return float(time_s.sum()), float((time_s * speeds).sum())


def pressing_depth(trajectory: Trajectory) -> float | None:
    """Return how deep the tool was pressed into the head, mm; None if not recorded.

    sqrt(Σ kᵢ·dᵢ² / n) with dᵢ the greatest depth in contact i, kᵢ the number of kept touches in it,
    at least 1, and n the number of fiducials, or of kept touches while these are secret, and of
    the contacts in which something was traced. Further contacts can only add to the sum.
    """
    if trajectory.depth_mm is None:
        return None
    touch_times = trajectory.touch_times_s
    total = 0.0
    for contact in trajectory.contacts:
        touched = (contact.start_s <= touch_times) & (touch_times <= contact.end_s)
        total += max(1, int(touched.sum())) * contact.greatest_depth_mm**2
    count = len(trajectory.fiducials_mm) or len(touch_times)
    traced = [touch.time_s for touch in trajectory.traced]
    strokes = sum(any(c.start_s <= t <= c.end_s for t in traced) for c in trajectory.contacts)
    return float(np.sqrt(total / (count + strokes or 1)))


def _distance_to_touches(
    touches: Sequence[Touch], times: np.ndarray, tip: np.ndarray
) -> np.ndarray:
    """Return the tip's distance to the previous or next touch, the nearer one, (n,) float, mm."""
    places = np.array([touch.position_mm for touch in touches], dtype=float).reshape(-1, 3)
    if not len(places):
        return np.full(len(times), np.inf)
    following = np.searchsorted(np.array([touch.time_s for touch in touches]), times)
    neighbors = (np.maximum(following - 1, 0), np.minimum(following, len(places) - 1))
    return np.minimum(*(np.linalg.norm(tip - places[rows], axis=1) for rows in neighbors))
