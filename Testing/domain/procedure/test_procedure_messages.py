"""A procedure at all of its limits still fits into the messages, the study and the score."""

import json

import numpy as np

from rastrainer import commands, transforms
from rastrainer.json_checks import MAX_MESSAGE_VALUES, MAX_RECORD_VALUES
from rastrainer.json_records import record_from_json
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import MAX_TRAJECTORIES, ProcedureKind
from rastrainer.procedure.record import (
    MAX_ALIGNMENTS,
    MAX_ATTEMPTS,
    MAX_FEED_METRICS,
    MAX_TOUCHED_CHECKPOINTS,
)
from rastrainer.protocol import FIDUCIAL_COUNT, PROCEDURE_PHASES
from rastrainer.study.database.study import RECORD_LIMIT_BYTES
from rastrainer.trial.procedure_outcome import ProcedureMeasures, ProcedureOutcome, score_procedure
from rastrainer.trial.record import TrialRecord
from Testing.domain.procedure.made_up_procedure import made_up_meshes, made_up_procedure, trajectory
from Testing.domain.procedure.procedure_records import recorded
from Testing.domain.trial.trial_records import make_record

DIGITS = 123.45678901234567
PHASES = ["running", *(phase.value for phase in PROCEDURE_PHASES)]


def largest_record():
    """The record of a trial whose procedure reaches every limit, with all digits."""
    turned = [*np.eye(4).ravel().tolist()]
    checked = {"name": "C" * 60, "positionMm": [DIGITS] * 3, "errorMm": DIGITS, "simTimeS": DIGITS}
    per_attempt, more = divmod(MAX_TOUCHED_CHECKPOINTS, MAX_ATTEMPTS)
    assert more == 0
    attempt = {
        "touches": [
            {"label": str(number + 1), "positionMm": [DIGITS] * 3}
            for number in range(FIDUCIAL_COUNT)
        ],
        "registration": {"matrix": turned, "freMm": DIGITS, "expectedTreMm": DIGITS},
        "checkpoints": [checked] * per_attempt,
    }
    instruments = [
        {
            "trajectory": f"Line {number} {'x' * 50}",
            "entryRas": [DIGITS] * 3,
            "targetRas": [DIGITS] * 3,
            "diameterMm": 1.3,
            "guideTipMm": [DIGITS] * 3,
            "guideDirection": [0.0, 0.0, -1.0],
            "alignments": MAX_ALIGNMENTS,
            "drillDepthMm": DIGITS,
            "instrumentDepthMm": DIGITS,
            "selfAligned": True,
            "timesS": dict.fromkeys(PHASES, DIGITS),
            "feed": {f"metric_{metric}": DIGITS for metric in range(MAX_FEED_METRICS)},
        }
        for number in range(MAX_TRAJECTORIES)
    ]
    return make_record(
        procedure={
            "procedure": "p" * 40,
            "kind": ProcedureKind.SEEG.value,
            "sha256": "0" * 64,
            "durationS": 9999.0,
            "attempts": [attempt] * MAX_ATTEMPTS,
            "instruments": instruments,
            "phaseTimesS": dict.fromkeys(PHASES, DIGITS),
        }
    )


def test_slicer_accepts_the_record_of_the_longest_procedure_and_a_study_stores_it():
    record = largest_record()
    text = json.dumps(record)
    assert MAX_MESSAGE_VALUES < text.count(",") < MAX_RECORD_VALUES
    read = record_from_json(TrialRecord, commands.decode_answer_object(text)).procedure
    assert len(read.attempts) == MAX_ATTEMPTS
    assert sum(len(attempt.checkpoints) for attempt in read.attempts) == MAX_TOUCHED_CHECKPOINTS
    assert len(read.instruments) == MAX_TRAJECTORIES
    assert len(text) < RECORD_LIMIT_BYTES


def test_the_simulator_accepts_the_score_of_the_longest_procedure():
    lines = [
        trajectory(f"{number} {'x' * 50}", (0.0, number - 10.0, 89.0), (0.0, 0.0, 20.0))
        for number in range(MAX_TRAJECTORIES)
    ]
    procedure = made_up_procedure(*lines)
    off = transforms.rigid(np.eye(3), np.array([0.123456789, 0.4, 0.0]))
    analysis = analyze_procedure(recorded(procedure, off), procedure, made_up_meshes(), np.eye(4))
    score = score_procedure(ProcedureMeasures.of(analysis, procedure), 300.0)
    details = {
        "procedure": ProcedureOutcome(analysis, score).summary(),
        "residualsMm": [DIGITS] * 15,
    }
    text = json.dumps({"trialId": make_record()["trialId"], "score": 50.0, "details": details})
    checked = commands.check_arguments(
        commands.CommandName.TRIAL_SCORED, commands.decode_json_object(text)
    )
    assert len(checked["details"]["procedure"]["trajectories"]) == MAX_TRAJECTORIES
