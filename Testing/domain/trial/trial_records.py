"""A trial record as the simulator delivers it."""

import uuid


def make_record(**changes):
    points = [
        {
            "label": str(i + 1),
            "positionMm": [500.0 + i, -20.0 * i, 300.25],
            "simTime": 5.0 + 7.5 * i,
            "utc": f"2024-05-17T09:30:{i:02d}.250Z",
        }
        for i in range(15)
    ]
    record = {
        "trialId": str(uuid.UUID(int=7)),
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
    }
    return {**record, **changes}
