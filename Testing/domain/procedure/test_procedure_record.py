"""The record of a procedure: written and read again, and refused where it cannot be one."""

import json

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.trial.record import TrialRecord
from Testing.domain.procedure.made_up_procedure import made_up_procedure
from Testing.domain.procedure.procedure_records import recorded
from Testing.domain.trial.trial_records import make_record


@pytest.fixture
def record():
    return recorded(made_up_procedure(), np.eye(4))


def written(record):
    """As it is decoded from a message or a file."""
    return json.loads(json.dumps(record_to_json(record)))


def test_a_record_is_read_as_it_was_written(record):
    again = record_from_json(ProcedureRecord, written(record))
    assert again == record
    assert again.accepted == record.attempts[-1].registration
    assert sum(each.alignments for each in again.instruments) == 2
    assert again.accepted.world_to_head.tolist() == np.eye(4).tolist()


def test_a_point_on_the_guides_axis_is_beyond_its_tip(record):
    left = record.instruments[0]
    assert left.at_depth(left.instrument_depth_mm).tolist() == [0.0, 0.0, 20.0]


def test_unknown_keys_of_a_later_version_are_ignored(record):
    value = written(record)
    value["later"] = value["instruments"][0]["later"] = 1
    assert record_from_json(ProcedureRecord, value) == record


def test_the_record_of_a_trial_holds_that_of_its_procedure(record):
    value = {**make_record(), "procedure": written(record)}
    trial = record_from_json(TrialRecord, value)
    assert trial.procedure == record
    assert record_from_json(TrialRecord, written(trial)) == trial


def test_the_record_of_a_trial_with_touches_only_is_unchanged():
    trial = record_from_json(TrialRecord, make_record())
    assert trial.procedure is None
    assert "procedure" not in record_to_json(trial)


def set_in(*path_and_value):
    *path, value = path_and_value

    def change(values):
        for step in path[:-1]:
            values = values[step]
        values[path[-1]] = value

    return change


SHEAR = [1, 0.1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
MIRROR = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
MATRIX = ("attempts", 1, "registration", "matrix")
PLACED = ("instruments", 0)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (set_in("kind", "heart"), "kind must be one of"),
        (set_in("attempts", []), "a list of 1 to 100 attempts"),
        (set_in("attempts", 1, "registration", None), "must end with an accepted registration"),
        (set_in(*MATRIX, SHEAR), "must be a rigid transform"),
        (set_in(*MATRIX, MIRROR), "must be a rigid transform"),
        (set_in(*MATRIX, [0] * 15), "must be a list of 16 numbers"),
        (set_in("instruments", []), "a list of 1 to 20 instruments"),
        (set_in(*PLACED, "guideDirection", [0, 0, 0.9]), "must be a unit vector"),
        (set_in(*PLACED, "guideTipMm", [0, 0, float("nan")]), "a list of 3 numbers"),
        (set_in(*PLACED, "instrumentDepthMm", -1.0), "from 0 to 1000 mm"),
        (set_in(*PLACED, "alignments", 0), "a whole number from 1"),
        (
            set_in(*PLACED, "timesS", {"sleeping": 1.0}),
            "timesS must be an object, its names one of running",
        ),
        (
            set_in(*PLACED, "feed", {"path": "long"}),
            "feed.path must be a number from 0",
        ),
        (set_in("durationS", True), "durationS must be a number"),
        (set_in("attempts", 1, "checkpoints", [7]), "must be a JSON object"),
    ],
)
def test_an_invalid_record_is_refused_in_one_sentence(record, change, sentence):
    value = written(record)
    change(value)
    with pytest.raises(InputError, match=sentence) as caught:
        record_from_json(ProcedureRecord, value)
    assert "\n" not in str(caught.value)


def test_a_key_missing_from_a_record_is_named(record):
    value = written(record)
    del value["instruments"][0]["drillDepthMm"]
    with pytest.raises(InputError, match='needs the key "drillDepthMm"'):
        record_from_json(ProcedureRecord, value)
