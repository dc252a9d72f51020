"""Touches that degraded a registration, and why; and what would have raised the score most."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import Enum

import numpy as np

from rastrainer.motion.trajectory import Touch, Trajectory
from rastrainer.motion.trial_motion import DWELL_RADIUS_MM
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import CommonBias
from rastrainer.trial.scoring import DEPTH_LIMIT_MM, TrialScore, score_trial
from rastrainer.trial.wording import Sentence, say

OUTLIER_SHARE = 2.0
"""An outlier has at least twice the squared error of an average touch."""
HURRY_SHARE = 0.6
HURRY_DWELL_S = 0.15
SHAKING_WINDOW_S = 0.5
SHAKING_MM = 0.6
SHAKING_RADIUS_MM = 5.0


class Reason(str, Enum):
    """Why a touch was inaccurate."""

    DEPTH = "depth"
    ASIDE = "aside"
    HURRY = "hurry"
    SHAKING = "shaking"


@dataclass(frozen=True)
class TouchFinding:
    """The analysis of one touch.

    Attributes:
        depth_mm: Part along the skin's outward normal, positive off the skin.
        share: Of the squared registration error, 0 to 1.
        dwell_s: How long the tip had been within 2 mm; None without a recording.
        reasons: The main one first.
        replay_s: Start and end for a replay, in trial time; None without a recording.
    """

    label: str
    residual_mm: float
    depth_mm: float
    share: float
    dwell_s: float | None
    is_outlier: bool
    reasons: tuple[Reason, ...]
    replay_s: tuple[float, float] | None

    @property
    def sentence(self) -> Sentence:
        where: Sentence | str = ""
        if Reason.DEPTH in self.reasons:
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
            shaking=say("touch shaking") if Reason.SHAKING in self.reasons else "",
        )


def touch_findings(
    registration: Registration, normals: np.ndarray, trajectory: Trajectory | None = None
) -> tuple[TouchFinding, ...]:
    """Return a finding for each touch of a registration, in its order.

    `normals` are the skin's outward unit normals (n, 3) at the fixed points, RAS. Touches are
    found in the trajectory by label.
    """
    squares = registration.residuals_mm**2
    total = float(squares.sum())
    touches = {touch.label: i for i, touch in enumerate(trajectory.touches)} if trajectory else {}
    findings = []
    for row, label in enumerate(registration.labels):
        residual = float(registration.residuals_mm[row])
        share = float(squares[row]) / total if total > 0 else 0.0
        is_outlier = share * len(squares) >= OUTLIER_SHARE
        dwell = replay = None
        depth = float(registration.residual_vectors_mm[row] @ normals[row])
        aside = float(np.sqrt(max(residual**2 - depth**2, 0.0)))
        reasons = [Reason.DEPTH if abs(depth) > aside else Reason.ASIDE]
        if trajectory is not None and label in touches:
            dwell, replay, how = _touched(trajectory, touches[label])
            reasons += how
        why = tuple(reasons) if is_outlier else ()
        known = label, residual, depth, share, dwell
        findings.append(TouchFinding(*known, is_outlier, why, replay))
    return tuple(findings)


def _touched(trajectory: Trajectory, index: int) -> tuple[float, tuple[float, float], list[Reason]]:
    """Return the dwell of a touch (s), its start and end, and whether it was shaky or hurried."""
    touches = trajectory.touches
    touch, before = touches[index], touches[index - 1].time_s if index else 0.0
    dwell, shaking = _last_moments(trajectory, touch)
    usual = float(np.median(np.diff([each.time_s for each in touches]))) if touches[1:] else 0.0
    is_short = index > 0 and touch.time_s - before < HURRY_SHARE * usual
    how = [Reason.SHAKING] if shaking > SHAKING_MM else []
    if is_short or (dwell < HURRY_DWELL_S and shaking <= SHAKING_MM):
        how.append(Reason.HURRY)
    return dwell, (before, touch.time_s), how


def _last_moments(trajectory: Trajectory, touch: Touch) -> tuple[float, float]:
    """Return how long the tip had been near when it touched (s), and how much it shook (mm)."""
    until = int(np.searchsorted(trajectory.times_s, touch.time_s, side="right"))
    times, tip = trajectory.times_s[:until], trajectory.tip_mm[:until]
    if until == 0:
        return 0.0, 0.0
    away = np.linalg.norm(tip - touch.position_mm, axis=1)
    dwell = touch.time_s - _since(times, away > DWELL_RADIUS_MM)
    # A shaking hand leaves the dwell's radius again and again, but hardly this one.
    near_since = _since(times, away > SHAKING_RADIUS_MM)
    last = tip[times >= max(touch.time_s - SHAKING_WINDOW_S, near_since)]
    if len(last) < 4:
        return dwell, 0.0
    # The tip also moves toward its aim; only what goes to and fro is shaking.
    steps = np.linspace(-1, 1, len(last))[:, None]
    toward = last.mean(axis=0) + steps * (steps * last).sum(axis=0) / (steps**2).sum()
    return dwell, float(np.sqrt(((last - toward) ** 2).sum(axis=1).mean()))


def _since(times: np.ndarray, is_far: np.ndarray) -> float:
    far = np.flatnonzero(is_far)
    return float(times[min(far[-1] + 1, len(times) - 1)] if len(far) else times[0])


GOOD_EFFICIENCY = 0.35
"""Reached by straight paths with lifts of 35 mm, even between near fiducials.

Virtual trainees who move like this reach 0.36 in task 1 and 0.50 in task 5."""
ATTEMPT_S = 3.0
"""Minimum time lost by a refused touch."""
LONG_CONTACT_S = 2.0
"""Longer contact is described by its duration, not as a bump."""
MINOR_SHARE = 0.5
"""A second direction of a common bias is named from this share of the first one on."""
MIN_GAIN = 0.5
MAX_ADVICE = 3


@dataclass(frozen=True)
class Advice:
    """One improvement, and about how many points it gains."""

    sentence: Sentence
    gain: float


def advise(
    score: TrialScore | None,
    findings: Sequence[TouchFinding],
    motion: Mapping[str, float],
    bias: CommonBias | None = None,
) -> tuple[Advice, ...]:
    """Return up to three improvements, the most rewarding first.

    Unintended contact and pressing come first regardless of points: safety has priority. So does a
    common bias beyond its limit, after them: without it, the target error would be another one,
    too. Without a score of touched fiducials there is no other advice.
    """
    if score is None or score.is_unbiased is None:
        return tuple(_contacts(motion, 0.0))
    first = list(_contacts(motion, _gain(score, contact_time_s=0.0, contact_path_mm=0.0)))
    depth, gain = score.measures.pressing_depth_mm, _gain(score, pressing_depth_mm=0.0)
    if depth > DEPTH_LIMIT_MM or gain >= MIN_GAIN:
        first.append(Advice(say("pressing", depth=depth), gain))
    candidates = [*_accuracy(score, findings), *_time(score, motion)]
    if bias is not None and score.is_unbiased is False:
        first.append(_common_bias(score, bias))
    elif bias is not None and bias.is_shown:
        candidates.append(_common_bias(score, bias))
    ranked = sorted(candidates, key=lambda advice: -advice.gain)
    worth = [advice for advice in ranked if advice.gain >= MIN_GAIN]
    return (*first, *worth)[:MAX_ADVICE]


def _contacts(motion: Mapping[str, float], gain: float) -> Iterator[Advice]:
    count = int(motion.get("unintended_contacts", 0))
    seconds = float(motion.get("unintended_contact_time_s", 0.0))
    if seconds >= LONG_CONTACT_S:
        path = float(motion.get("unintended_contact_path_mm", 0.0))
        yield Advice(say("dragging", time=seconds, path=path), gain)
    elif count:
        sentence = say("contact") if count == 1 else say("contacts", count=count)
        yield Advice(sentence, gain)


_DIRECTIONS = (
    ("bias to the left", "bias to the right"),
    ("bias to the back", "bias to the face"),
    ("bias to the neck", "bias to the crown"),
)
"""Keys for the negative and the positive direction of the axes R, A and S."""


def _common_bias(score: TrialScore, bias: CommonBias) -> Advice:
    """Return the advice; its gain leaves out that the target error would be smaller, too."""
    most, second = sorted(range(3), key=lambda axis: -abs(bias.vector_mm[axis]))[:2]
    first, other = (say(_DIRECTIONS[axis][bias.vector_mm[axis] > 0]) for axis in (most, second))
    if abs(bias.vector_mm[second]) < MINOR_SHARE * abs(bias.vector_mm[most]):
        sentence = say("common bias", bias=bias.length_mm, direction=first)
    else:
        sentence = say("oblique common bias", bias=bias.length_mm, direction=first, second=other)
    return Advice(sentence, _gain(score, common_bias_mm=0.0))


def _accuracy(score: TrialScore, findings: Sequence[TouchFinding]) -> Iterator[Advice]:
    residuals = np.array([finding.residual_mm for finding in findings])
    total = float((residuals**2).sum())
    if total <= 0:
        return
    outliers = [finding for finding in findings if finding.is_outlier]
    if outliers:
        typical = float(np.median(residuals))
        better = sum(
            (typical if finding.is_outlier else finding.residual_mm) ** 2 for finding in findings
        )
        yield Advice(
            say(
                "worst touch" if len(outliers) == 1 else "worst touches",
                points=", ".join(finding.label for finding in outliers),
                share=100 * (1 - math.sqrt(better / total)),
            ),
            _gain(score, error_factor=math.sqrt(better / total)),
        )
    in_depth = float((np.array([finding.depth_mm for finding in findings]) ** 2).sum())
    if in_depth > 0.5 * total:
        yield Advice(
            say("depth"),
            _gain(score, error_factor=math.sqrt(max(1 - in_depth / total, 0.04) / 0.75)),
        )


def _time(score: TrialScore, motion: Mapping[str, float]) -> Iterator[Advice]:
    time = score.measures.completion_time_s
    idle = motion.get("idle_time_s", 0.0)
    if idle > 0:
        yield Advice(
            say("idle time", idle=float(idle), time=time),
            # Half of it is needed to aim.
            _gain(score, time_s=time - idle / 2),
        )
    efficiency = motion.get("path_efficiency", GOOD_EFFICIENCY)
    if efficiency < GOOD_EFFICIENCY:
        moving = time - idle
        yield Advice(
            say("detours", times=1 / efficiency),
            _gain(score, time_s=time - moving * (1 - efficiency / GOOD_EFFICIENCY)),
        )
    refused = int(motion.get("refused_touches", 0) + motion.get("undone_touches", 0))
    if refused:
        yield Advice(
            say("repeated touch") if refused == 1 else say("repeated touches", count=refused),
            _gain(score, time_s=max(time - ATTEMPT_S * refused, 0.2 * time)),
        )
    slow = time / score.reference.time_s
    if slow > 1.3:
        yield Advice(
            say("pace", time=time, usual=float(score.reference.time_s)),
            0.5 * _gain(score, time_s=score.reference.time_s),
        )


def _gain(
    score: TrialScore, time_s: float | None = None, error_factor: float = 1.0, **others: float
) -> float:
    measures = replace(
        score.measures,
        completion_time_s=max(time_s or score.measures.completion_time_s, 1e-3),
        # On average, the target error is proportional to the registration error.
        tre_mm=score.measures.tre_mm * min(error_factor, 1.0),
        **others,
    )
    return max(0.0, score_trial(measures, score.reference).score - score.score)
