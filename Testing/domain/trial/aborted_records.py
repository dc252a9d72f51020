"""The record of an aborted trial as the simulator delivers it."""

import uuid

from Testing.domain.trial.trial_records import make_record


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
