"""How gently the head was treated: contact that was not meant, and how deep it was pressed.

Both follow from the samples as they were recorded, unfiltered, and from nothing that a trainee can
make smaller by touching the head once more.
"""

from __future__ import annotations

import numpy as np

from rastrainer.motion.trajectory import Trajectory

INTENDED_MM = 5.0
"""Contact with the tip within this distance of a touch is meant."""


def unintended_contact(trajectory: Trajectory) -> tuple[float, float]:
    """Return the time (s) of contact that was not meant and the tip's way (mm) meanwhile.

    Contact is not meant while the tip is farther than `INTENDED_MM` from both the place that is
    touched next and the one touched last, of the kept touches; where there are none, all is. The
    tip goes straight from sample to sample. Between neighboring samples or touches the place in the
    middle decides, and what is in contact of the time between them counts.
    """
    contacts, samples_s = trajectory.contacts, trajectory.times_s
    if not contacts or not len(samples_s):
        return float(sum(contact.duration_s for contact in contacts)), 0.0
    # Before the first sample and after the last the tip is where that one has it.
    ends = [min(c.start_s for c in contacts), max(c.end_s for c in contacts)]
    outer = [time for time in ends if not samples_s[0] <= time <= samples_s[-1]]
    times = np.unique(np.concatenate([samples_s, trajectory.touch_times_s, outer]))
    tip = np.column_stack([np.interp(times, samples_s, axis) for axis in trajectory.tip_mm.T])
    begins, steps = times[:-1], np.diff(times)
    middle = (tip[:-1] + tip[1:]) / 2
    counts = _distance_to_touches(trajectory, begins + steps / 2, middle) > INTENDED_MM
    in_contact = np.zeros(len(steps))
    for contact in contacts:
        in_contact += np.clip(contact.end_s, begins, times[1:]) - np.clip(
            contact.start_s, begins, times[1:]
        )
    speeds = np.linalg.norm(np.diff(tip, axis=0), axis=1) / steps
    time_s = in_contact * counts
    return float(time_s.sum()), float((time_s * speeds).sum())


def pressing_depth(trajectory: Trajectory) -> float | None:
    """Return how deep the tool was pressed into the head, mm; None where that was not recorded.

    sqrt(Σ kᵢ·dᵢ² / n) with dᵢ the greatest depth in contact i, kᵢ how many kept touches were made
    in it, at least 1, and n the fiducials of the task, or the kept touches as long as these are a
    secret. Further contacts can only add to the sum.
    """
    if trajectory.depth_mm is None:
        return None
    touch_times = trajectory.touch_times_s
    total = 0.0
    for contact in trajectory.contacts:
        touched = (contact.start_s <= touch_times) & (touch_times <= contact.end_s)
        total += max(1, int(touched.sum())) * contact.greatest_depth_mm**2
    return float(np.sqrt(total / (len(trajectory.fiducials_mm) or len(touch_times) or 1)))


def _distance_to_touches(trajectory: Trajectory, times: np.ndarray, tip: np.ndarray) -> np.ndarray:
    """Return how far the tip is from the nearer of the last and the next touch, (n,) float, mm."""
    places = trajectory.touch_positions_mm
    if not len(places):
        return np.full(len(times), np.inf)
    following = np.searchsorted(trajectory.touch_times_s, times)
    neighbors = (np.maximum(following - 1, 0), np.minimum(following, len(places) - 1))
    return np.minimum(*(np.linalg.norm(tip - places[rows], axis=1) for rows in neighbors))
