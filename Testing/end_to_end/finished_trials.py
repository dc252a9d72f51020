"""Folders of finished trials, as left by a simulator without a connection."""

from __future__ import annotations

import uuid
from pathlib import Path

import numpy as np

from rastrainer.journal.entries import Registered
from rastrainer.journal.folder import SUFFIX
from rastrainer.json_records import record_to_json
from rastrainer.protocol import Phase
from rastrainer.scenario.scenario import load_scenario
from rastrainer.trial.record import TouchedPoint, TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.training.head_pose import Truth
from Testing.journal_lines import at, header

COLIN = asset_path("scenarios", "colin27")
TRAINEE = "T-042"
TASK = "task-1"


def write_finished_trials(folder: Path, numbers: range) -> list[str]:
    """Write a registered trial for each number and return their UUIDs."""
    scenario = load_scenario(COLIN)
    return [_write(folder, number, scenario) for number in numbers]


def _write(folder: Path, number: int, scenario) -> str:
    trial_id = str(uuid.UUID(int=number, version=4))
    task = scenario.task(TASK)
    truth = Truth(
        scenario.perturbed_head_to_world(number),
        scenario.target.position_ras,
        dict(zip(task.labels, task.fiducials, strict=True)),
    )
    rng = np.random.default_rng(number)
    utc = f"2024-05-17T{number // 3600 % 24:02d}:{number // 60 % 60:02d}:{number % 60:02d}.000Z"
    record = TrialRecord(
        trial_id=trial_id,
        trainee=TRAINEE,
        task=TASK,
        mode="desktop",
        scenario=scenario.name,
        started_utc=utc,
        completed_utc=utc,
        completion_time_s=90.0 + number % 30,
        points=tuple(
            TouchedPoint(label, tuple(truth.in_world(point + rng.normal(0, 0.7, 3))), n, utc)
            for n, (label, point) in enumerate(truth.fiducials_ras.items())
        ),
        rejected_touches=0,
        undone_touches=0,
        versions={"rastrainer": "0"},
        motion=dict.fromkeys(SAFETY_METRICS, 0.0),
    )
    texts = dict.fromkeys(("trial_id", "trainee", "task", "mode", "instruction"), "")
    registered = Registered(
        **texts,
        phase=Phase.REGISTERED,
        next_point=None,
        truth=truth,
        record=record_to_json(record),
        seed=number,
    )
    journal = Journal(folder / f"20240517T{number:06d}Z_{trial_id}{SUFFIX}")
    journal.write_lines([at(0.0, header()), at(0.0, registered)], sync=False)
    journal.close()
    return trial_id
