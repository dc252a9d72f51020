"""A drill's record as JSON: it comes back whole, and hostile records are refused with a reason."""

import json

import numpy as np
import pytest

from rastrainer.decision.drill_record import FAULTS, DrillRecord, Fault
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from Testing.drawn_drills import draw_drill


def drill(seed=1):
    return draw_drill(np.random.default_rng(seed))


def changed(**changes):
    """Return a drill's JSON with changed values of its first case."""
    content = record_to_json(drill())
    return {**content, "cases": [{**content["cases"][0], **changes}, *content["cases"][1:]]}


@pytest.mark.parametrize("seed", range(5))
def test_a_record_comes_back_from_its_json(seed):
    record = drill(seed)
    text = json.dumps(record_to_json(record), allow_nan=False)
    assert record_from_json(DrillRecord, json.loads(text)) == record


def test_a_case_is_right_if_it_proceeds_within_the_limit_or_refuses_beyond_it():
    for case in drill().cases:
        assert case.is_sound == (case.true_error_mm <= case.limit_mm)
        assert case.is_right == (case.is_sound == (case.decision.value == "proceed"))


def test_every_fault_but_none_is_repeatable_or_has_a_cause_to_be_found():
    assert {*FAULTS, Fault.NONE} == set(Fault)
    assert {fault for fault in FAULTS if fault.is_repeatable} == {
        Fault.BAD_FIDUCIAL,
        Fault.SWAPPED,
        Fault.SLID_TRACE,
        Fault.MOVED_HEAD,
    }


@pytest.mark.parametrize(
    ("changes", "named"),
    [
        ({"seed": -1}, "seed"),
        ({"seed": 2**63}, "seed"),
        ({"seed": 1.5}, "seed"),
        ({"fault": "gremlins"}, "fault"),
        ({"method": "guess"}, "method"),
        ({"trueErrorMm": float("nan")}, "trueErrorMm"),
        ({"trueErrorMm": -0.1}, "trueErrorMm"),
        ({"residualMm": "2"}, "residualMm"),
        ({"difficulty": 1e3}, "difficulty"),
        ({"checks": ["nose"] * 13}, "checks"),
        ({"checks": ["nose\n"]}, "checks"),
        ({"checks": [3]}, "checks"),
        ({"hasReadImages": "yes"}, "hasReadImages"),
        ({"decision": "hope"}, "decision"),
        ({"confidence": 49}, "confidence"),
        ({"confidence": 101}, "confidence"),
        ({"suspected": "gremlins"}, "suspected"),
        ({"timeS": -1.0}, "timeS"),
    ],
)
def test_a_wrong_value_of_a_case_is_refused_by_its_name(changes, named):
    with pytest.raises(InputError, match=named):
        record_from_json(DrillRecord, changed(**changes))


@pytest.mark.parametrize(
    "changes",
    [
        {"cases": []},
        {"cases": [{}]},
        {"cases": "none"},
        {"trialId": "../../etc"},
        {"trainee": "two\nlines"},
        {"mode": "telepathy"},
        {"startedUtc": "yesterday"},
        {"versions": ["1"]},
        {"journalSha256": "x" * 65},
    ],
)
def test_a_wrong_value_of_a_drill_is_refused(changes):
    with pytest.raises(InputError, match=next(iter(changes))):
        record_from_json(DrillRecord, {**record_to_json(drill()), **changes})


def test_a_drill_has_at_most_a_hundred_cases():
    content = record_to_json(drill())
    with pytest.raises(InputError, match="cases"):
        record_from_json(DrillRecord, {**content, "cases": content["cases"] * 6})
