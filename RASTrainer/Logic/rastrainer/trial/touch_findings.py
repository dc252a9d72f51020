"""Touches that degraded the registration, and why."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from rastrainer.motion.trajectory import Touch, Trajectory
from rastrainer.motion.trial_motion import DWELL_RADIUS_MM
from rastrainer.registration.registration import Registration
from rastrainer.trial.wording import Sentence, say

OUTLIER_SHARE = 2.0
"""An outlier has at least twice the squared error of an average touch."""
HURRY_SHARE = 0.6
HURRY_DWELL_S = 0.15
TREMOR_WINDOW_S = 0.5
TREMOR_MM = 0.6
TREMOR_RADIUS_MM = 5.0


class Reason(str, Enum):
    """Why a touch was inaccurate."""

    DEPTH = "depth"
    ASIDE = "aside"
    HURRY = "hurry"
    TREMOR = "tremor"


@dataclass(frozen=True)
class TouchFinding:
    """The analysis of one touch.

    Attributes:
        label: Of the fiducial.
        residual_mm: Distance of the registered touch from its fiducial.
        depth_mm: Part along the skin's outward normal, positive off the skin; None without skin.
        aside_mm: Part along the skin; None likewise.
        share: Of the squared registration error, 0 to 1.
        dwell_s: How long the tip had been within 2 mm; None without a recording.
        is_outlier: Whether it degraded the registration.
        reasons: The main one first; may be empty.
        replay_s: Start and end for a replay, in trial time; None without a recording.
    """

    label: str
    residual_mm: float
    depth_mm: float | None
    aside_mm: float | None
    share: float
    dwell_s: float | None
    is_outlier: bool
    reasons: tuple[Reason, ...]
    replay_s: tuple[float, float] | None

    @property
    def sentence(self) -> Sentence:
        """The finding in words, for the trainee."""
        where: Sentence | str = ""
        if self.depth_mm is not None and Reason.DEPTH in self.reasons:
            side = "touch above" if self.depth_mm > 0 else "touch below"
            where = say(side, depth=abs(self.depth_mm))
        elif Reason.ASIDE in self.reasons:
            where = say("touch aside")
        return say(
            "touch",
            label=self.label,
            residual=self.residual_mm,
            where=where,
            hurry=say("touch hurry") if Reason.HURRY in self.reasons else "",
            tremor=say("touch tremor") if Reason.TREMOR in self.reasons else "",
        )


def touch_findings(
    registration: Registration,
    normals: np.ndarray | None = None,
    trajectory: Trajectory | None = None,
) -> tuple[TouchFinding, ...]:
    """Return a finding for each touch of a registration, in its order.

    Args:
        registration: The scored, rigid one.
        normals: (n, 3) float, outward unit normals of the skin at the fixed points, RAS.
        trajectory: Of the trial; touches are found in it by label.
    """
    squares = registration.residuals_mm**2
    total = float(squares.sum())
    touches = {touch.label: i for i, touch in enumerate(trajectory.touches)} if trajectory else {}
    findings = []
    for row, label in enumerate(registration.labels):
        share = float(squares[row]) / total if total > 0 else 0.0
        depth = (
            None if normals is None else float(registration.residual_vectors_mm[row] @ normals[row])
        )
        findings.append(
            _finding(
                label,
                float(registration.residuals_mm[row]),
                depth,
                share,
                share * len(squares) >= OUTLIER_SHARE,
                trajectory,
                touches.get(label),
            )
        )
    return tuple(findings)


def _finding(
    label: str,
    residual: float,
    depth: float | None,
    share: float,
    is_outlier: bool,
    trajectory: Trajectory | None,
    index: int | None,
) -> TouchFinding:
    dwell = tremor = replay = None
    is_hurried = False
    if trajectory is not None and index is not None:
        touch = trajectory.touches[index]
        before = trajectory.touches[index - 1].time_s if index else 0.0
        dwell, tremor = _last_moments(trajectory, touch)
        is_short = index > 0 and touch.time_s - before < HURRY_SHARE * _typical(trajectory.touches)
        is_hurried = is_short or (dwell < HURRY_DWELL_S and tremor <= TREMOR_MM)
        replay = (before, touch.time_s)
    aside = None if depth is None else float(np.sqrt(max(residual**2 - depth**2, 0.0)))
    reasons = []
    if is_outlier and depth is not None and aside is not None:
        reasons.append(Reason.DEPTH if abs(depth) > aside else Reason.ASIDE)
    if is_outlier and tremor is not None and tremor > TREMOR_MM:
        reasons.append(Reason.TREMOR)
    if is_outlier and is_hurried:
        reasons.append(Reason.HURRY)
    return TouchFinding(
        label, residual, depth, aside, share, dwell, is_outlier, tuple(reasons), replay
    )


def _last_moments(trajectory: Trajectory, touch: Touch) -> tuple[float, float]:
    """Return how long the tip had been near when it touched (s), and how much it shook (mm)."""
    until = int(np.searchsorted(trajectory.times_s, touch.time_s, side="right"))
    times, tip = trajectory.times_s[:until], trajectory.tip_mm[:until]
    if until == 0:
        return 0.0, 0.0
    away = np.linalg.norm(tip - touch.position_mm, axis=1)
    dwell = touch.time_s - _since(times, away > DWELL_RADIUS_MM)
    # A shaking hand leaves the dwell's radius again and again, but hardly this one.
    near_since = _since(times, away > TREMOR_RADIUS_MM)
    last = tip[times >= max(touch.time_s - TREMOR_WINDOW_S, near_since)]
    if len(last) < 4:
        return dwell, 0.0
    # The hand also drifts toward its aim; only what goes to and fro is tremor.
    steps = np.linspace(-1, 1, len(last))[:, None]
    drift = last.mean(axis=0) + steps * (steps * last).sum(axis=0) / (steps**2).sum()
    return dwell, float(np.sqrt(((last - drift) ** 2).sum(axis=1).mean()))


def _since(times: np.ndarray, is_far: np.ndarray) -> float:
    """Return the time from which on nothing is far."""
    far = np.flatnonzero(is_far)
    return float(times[min(far[-1] + 1, len(times) - 1)] if len(far) else times[0])


def _typical(touches: Sequence[Touch]) -> float:
    times = [touch.time_s for touch in touches]
    return float(np.median(np.diff(times))) if len(times) > 1 else 0.0
