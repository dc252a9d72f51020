"""The trial record: what the simulator may deliver and the study may store."""

import json

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.trial.record import TrialRecord
from Testing.domain.trial.trial_records import make_record


def changed_point(index, **changes):
    record = make_record()
    record["points"][index].update(changes)
    return record


def test_a_trial_record_survives_json():
    record = record_from_json(TrialRecord, make_record())
    assert record_from_json(TrialRecord, json.loads(json.dumps(record_to_json(record)))) == record


def test_touches_are_arrays_in_their_order():
    record = record_from_json(TrialRecord, make_record())
    assert record.labels == tuple(str(i) for i in range(1, 16))
    np.testing.assert_allclose(record.positions_mm[2], [502.0, -40.0, 300.25])


def test_the_seed_may_be_kept_secret():
    record = make_record()
    del record["seed"]
    assert record_from_json(TrialRecord, record).seed is None


def test_keys_of_a_newer_simulator_are_ignored():
    assert record_from_json(TrialRecord, make_record(weather="fine")) == record_from_json(
        TrialRecord, make_record()
    )


@pytest.mark.parametrize(
    ("record", "words"),
    [
        ([], "must be a JSON object"),
        (None, "must be a JSON object"),
        ({}, 'needs the key "trialId"'),
        (make_record(trialId="seven"), "trialId must be the UUID"),
        (make_record(trainee=""), "trainee must be printable text"),
        (make_record(trainee="a\nb"), "trainee must be printable text"),
        (make_record(mode="cinema"), "mode must be one of desktop, hmd"),
        (make_record(startedUtc="yesterday"), "startedUtc must be an ISO 8601"),
        (make_record(startedUtc="2024-05-17T09:30:00"), "startedUtc must be an ISO 8601"),
        (make_record(startedUtc="2024-05-17T09:30:00+02:00"), "startedUtc must be an ISO 8601"),
        (make_record(completionTimeS=float("nan")), "completionTimeS must be a number"),
        (make_record(completionTimeS=-1), "completionTimeS must be a number"),
        (make_record(completionTimeS=True), "completionTimeS must be a number"),
        (make_record(points=[]), "points must be a list of 15 points"),
        (make_record(points=[1] * 15), r"points\[0\] must be a JSON object"),
        (make_record(rejectedTouches=1.5), "rejectedTouches must be a whole number"),
        (make_record(versions={"a": 1}), "versions.a must be printable text"),
        (make_record(skin=5), "skin must be a JSON object"),
        (make_record(skin=[1]), "skin must be a JSON object"),
        (make_record(skin={"seed": -1}), "skin.seed must be a whole number"),
        (changed_point(3, positionMm=[1, 2]), "positionMm must be a list of 3 numbers"),
        (changed_point(3, positionMm=[1, 2, float("inf")]), "positionMm must be a list"),
        (changed_point(3, positionMm=[1, 2, 10**400]), "positionMm must be a list"),
        (changed_point(3, label="3"), 'holds the label "3" twice'),
        (changed_point(3, simTimeS=0.5), "4 was touched before 3"),
    ],
)
def test_other_records_are_refused_in_one_sentence(record, words):
    with pytest.raises(InputError, match=words) as caught:
        record_from_json(TrialRecord, record)
    assert "\n" not in str(caught.value)


def test_the_longest_name_that_a_view_may_give_its_device_is_kept():
    display = {"kind": "headset", "device": "Q" * 80, "refreshHz": 90.0}
    assert record_from_json(TrialRecord, make_record(display=display)).display == display
