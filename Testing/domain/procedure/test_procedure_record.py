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


def test_the_record_of_a_trial_holds_that_of_its_procedure(record):
    value = {**make_record(), "procedure": written(record)}
    trial = record_from_json(TrialRecord, value)
    assert trial.procedure == record
    assert record_from_json(TrialRecord, written(trial)) == trial


SHEAR = [1, 0.1, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]
MIRROR = [-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]


@pytest.mark.parametrize("matrix", [SHEAR, MIRROR])
def test_a_registration_that_is_not_rigid_is_refused(record, matrix):
    value = written(record)
    value["attempts"][1]["registration"]["matrix"] = matrix
    with pytest.raises(InputError, match="matrix must be a rigid transform"):
        record_from_json(ProcedureRecord, value)


def test_a_direction_that_is_no_unit_vector_is_refused(record):
    value = written(record)
    value["instruments"][0]["guideDirection"] = [0, 0, 0.9]
    with pytest.raises(InputError, match="guideDirection must be a unit vector"):
        record_from_json(ProcedureRecord, value)


def test_a_record_must_end_with_an_accepted_registration(record):
    value = written(record)
    value["attempts"][1]["registration"] = None
    with pytest.raises(InputError, match="must end with an accepted registration"):
        record_from_json(ProcedureRecord, value)
