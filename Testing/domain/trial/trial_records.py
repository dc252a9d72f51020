"""Records of finished and aborted trials as the simulator delivers them, and scores of trials."""

from __future__ import annotations

import uuid

from rastrainer.protocol import COARSE_LANDMARKS, MIN_TRACE_POINTS
from rastrainer.trial.scoring import ScoreMeasures, ScoreReference, TrialScore, score_trial


def make_record(number=7, **changes):
    points = [
        {
            "label": str(i + 1),
            "positionMm": [500.0 + i, -20.0 * i, 300.25],
            "simTimeS": 5.0 + 7.5 * i,
            "utc": f"2024-05-17T09:30:{i:02d}.250Z",
        }
        for i in range(15)
    ]
    record = {
        "trialId": str(uuid.UUID(int=number)),
        "trainee": "T-001",
        "task": "task-1",
        "mode": "desktop",
        "scenario": "colin27",
        "startedUtc": "2024-05-17T09:30:00Z",
        "completedUtc": "2024-05-17T09:32:00+00:00",
        "completionTimeS": 110.0,
        "points": points,
        "rejectedTouches": 2,
        "undoneTouches": 1,
        "versions": {"simulator": "0.1.0"},
        "seed": 3,
        "touchRule": "within radius",
    }
    return {**record, **changes}


def make_traced(**changes):
    """Return the record of a trial that was registered by a trace over the skin."""
    trace = [[500.0 + i, -20.0, 300.25, 5.0 + i] for i in range(MIN_TRACE_POINTS)]
    points = make_record()["points"][:COARSE_LANDMARKS]
    return make_record(**{"method": "surface", "points": points, "trace": trace, **changes})


def make_aborted(number=900, touches=3, **changes):
    whole = make_record()
    record = {
        "trialId": str(uuid.UUID(int=number)),
        **{key: whole[key] for key in ("trainee", "task", "mode", "scenario", "startedUtc")},
        "abortedUtc": "2024-05-17T09:31:00Z",
        "elapsedS": 60.0,
        "phase": "complete" if touches == 15 else "running",
        "reason": "trainee",
        "points": whole["points"][:touches],
        "rejectedTouches": 1,
        "undoneTouches": 0,
        "versions": {"simulator": "0.1.0"},
        "touchRule": "on skin",
    }
    return {**record, **changes}


REFERENCE = ScoreReference(time_s=105.0, tre_mm=0.4)


def gentle_score(
    time_s: float, tre_mm: float, reference: ScoreReference = REFERENCE, common_bias_mm: float = 0.0
) -> TrialScore:
    """Return the score of a trial without unintended contact or pressing."""
    measures = ScoreMeasures(time_s, tre_mm, 0.0, 0.0, 0.0, common_bias_mm)
    return score_trial(measures, reference)
