"""What would have raised the score most: each thing with the points that it would bring."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.feedback.touch_findings import TouchFinding
from rastrainer.number_text import fixed
from rastrainer.scoring import TrialScore, score_trial

GOOD_EFFICIENCY = 0.55
"""What a direct way with the necessary lifts between the touches reaches."""
ATTEMPT_S = 3.0
"""What a refused touch costs at least: to notice, to move, to touch again."""
LEAST_GAIN = 0.5
MOST = 3


@dataclass(frozen=True)
class Advice:
    """One thing to improve.

    Attributes:
        topic: Short, for programs.
        sentence: For the trainee.
        gain: Points that the score would have been higher by, about.
    """

    topic: str
    sentence: str
    gain: float


def advise(
    score: TrialScore, findings: Sequence[TouchFinding], motion: Mapping[str, float]
) -> tuple[Advice, ...]:
    """Return up to three things to improve, the most rewarding first.

    A contact that was not meant comes first whatever it costs: safety is not bought with points.
    """
    candidates = [
        *_accuracy(score, findings),
        *_time(score, motion),
    ]
    ranked = sorted(candidates, key=lambda advice: -advice.gain)
    worth = [advice for advice in ranked if advice.gain >= LEAST_GAIN]
    return (*_safety(motion), *worth)[:MOST]


def _safety(motion: Mapping[str, float]) -> Iterator[Advice]:
    count = int(motion.get("unintended_contacts", 0))
    if count:
        times = "once" if count == 1 else f"{count} times"
        yield Advice(
            "contacts",
            f"You bumped into the head {times} on the way. Lift off before you travel to the next "
            "point.",
            0.0,
        )


def _accuracy(score: TrialScore, findings: Sequence[TouchFinding]) -> Iterator[Advice]:
    residuals = np.array([finding.residual_mm for finding in findings])
    total = float((residuals**2).sum())
    if total <= 0:
        return
    hurting = [finding for finding in findings if finding.hurts]
    if hurting:
        typical = float(np.median(residuals))
        better = sum(
            (typical if finding.hurts else finding.residual_mm) ** 2 for finding in findings
        )
        names = ", ".join(finding.label for finding in hurting)
        points = "point" if len(hurting) == 1 else "points"
        yield Advice(
            "worst touches",
            f"Take more care at the {points} {names}: without these errors the registration "
            f"would be about {100 * (1 - math.sqrt(better / total)):.0f} % more exact.",
            _gain(score, error_factor=math.sqrt(better / total)),
        )
    depths = [finding.depth_mm for finding in findings if finding.depth_mm is not None]
    if len(depths) == len(findings):
        in_depth = float((np.array(depths) ** 2).sum())
        if in_depth > 0.5 * total:
            yield Advice(
                "depth",
                "Most of the error is in depth: bring the tip all the way onto the skin, and look "
                "from the side before you touch.",
                _gain(score, error_factor=math.sqrt(max(1 - in_depth / total, 0.04) / 0.75)),
            )


def _time(score: TrialScore, motion: Mapping[str, float]) -> Iterator[Advice]:
    time = score.completion_time_s
    idle = motion.get("idle_time_s", 0.0)
    if idle > 0:
        yield Advice(
            "idle time",
            f"The tool stood still for {fixed(idle, 0)} s of {fixed(time, 0)} s: look for the next "
            "point while you are still at this one.",
            # Half of it is needed to aim and to hold still.
            _gain(score, time_s=time - idle / 2),
        )
    efficiency = motion.get("path_efficiency", GOOD_EFFICIENCY)
    if efficiency < GOOD_EFFICIENCY:
        moving = time - idle
        yield Advice(
            "detours",
            f"The tool went {fixed(1 / efficiency, 1)} times the shortest way: go around the head "
            "closer to it and in one sweep.",
            _gain(score, time_s=time - moving * (1 - efficiency / GOOD_EFFICIENCY)),
        )
    refused = int(motion.get("refused_touches", 0) + motion.get("undone_touches", 0))
    if refused:
        yield Advice(
            "repeated touches",
            f"{refused} touch{'es were' if refused > 1 else ' was'} refused or taken back: check "
            "the number of the point before you touch.",
            _gain(score, time_s=max(time - ATTEMPT_S * refused, 0.2 * time)),
        )
    slow = time / score.reference.time_s
    if slow > 1.3:
        yield Advice(
            "pace",
            f"You took {fixed(time, 0)} s where {fixed(score.reference.time_s, 0)} s are usual: "
            "travel faster between the points and slow down only near the skin.",
            0.5 * _gain(score, time_s=score.reference.time_s),
        )


def _gain(score: TrialScore, time_s: float | None = None, error_factor: float = 1.0) -> float:
    better = score_trial(
        max(time_s or score.completion_time_s, 1e-3),
        # The expected target error is proportional to the registration error.
        score.expected_tre_mm * min(error_factor, 1.0),
        score.reference,
    )
    return max(0.0, better.score - score.score)
