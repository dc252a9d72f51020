"""The trial record: what the simulator may deliver and the study may store."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json
from rastrainer.trial.record import TrialRecord
from Testing.domain.trial.trial_records import make_record


def changed_point(index, **changes):
    record = make_record()
    record["points"][index].update(changes)
    return record


def test_touches_are_arrays_in_their_order():
    record = record_from_json(TrialRecord, make_record())
    assert record.labels == tuple(str(i) for i in range(1, 16))
    np.testing.assert_allclose(record.positions_mm[2], [502.0, -40.0, 300.25])


@pytest.mark.parametrize(
    ("record", "words"),
    [
        (make_record(startedUtc="2024-05-17T09:30:00"), "startedUtc must be an ISO 8601"),
        (make_record(startedUtc="2024-05-17T09:30:00+02:00"), "startedUtc must be an ISO 8601"),
        (make_record(points=[]), "points must be a list of 15 points"),
        (changed_point(3, label="3"), 'holds the label "3" twice'),
        (changed_point(3, simTimeS=0.5), "4 was touched before 3"),
    ],
)
def test_rules_of_several_points_and_of_times_are_checked(record, words):
    with pytest.raises(InputError, match=words) as caught:
        record_from_json(TrialRecord, record)
    assert "\n" not in str(caught.value)


def test_the_longest_name_that_a_view_may_give_its_device_is_kept():
    display = {"kind": "headset", "device": "Q" * 80, "refreshHz": 90.0}
    assert record_from_json(TrialRecord, make_record(display=display)).display == display
