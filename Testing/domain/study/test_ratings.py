"""Ratings are stored once, kept, corrected by further rows, and the same trials for all raters."""

import random
import uuid

import pytest

from rastrainer.errors import InputError
from rastrainer.study.ratings import GEARS, OSATS, RatingStore
from rastrainer_simulator.rating.rating_work import RatingWork
from Testing.domain.trial.trial_records import make_record

TRIALS = [str(uuid.UUID(int=number)) for number in range(1, 9)]


@pytest.fixture
def study(study):
    for number, trial_id in enumerate(TRIALS):
        study.add_trial(make_record(trialId=trial_id, trainee=f"T{number % 3}"))
    return study


@pytest.fixture
def store(study):
    return RatingStore(study)


def rows(study, table="rating_marks"):
    return study.database.row(f"SELECT count(*) FROM {table}")[0]


def test_all_raters_get_the_same_trials_each_in_their_own_order(store):
    orders = [store.assign(rater, TRIALS, 6, random.Random(rater)) for rater in ("R1", "R2")]
    assert len(set(orders[0])) == 6
    assert sorted(orders[0]) == sorted(orders[1])
    assert orders[0] != orders[1]
    assert list(orders[0]) != sorted(orders[0])


def test_replays_already_assigned_keep_their_order_and_further_ones_are_appended(store):
    first = store.assign("R1", TRIALS, 3, random.Random(1))
    assert store.assign("R1", TRIALS, 3, random.Random(2)) == first
    more = store.assign("R1", TRIALS, 5, random.Random(3))
    assert more[:3] == first
    assert sorted(store.assign("R2", TRIALS, 1, random.Random(4))) == sorted(more)
    assert len(store.assign("R1", TRIALS, 100, random.Random(5))) == len(TRIALS)


def test_a_mark_is_stored_once_and_a_different_one_under_its_uuid_is_refused(study, store):
    (trial_id, *_) = store.assign("R1", TRIALS, 2, random.Random(1))
    mark = (str(uuid.uuid4()), "R1", trial_id, GEARS, "gears_depth")
    assert store.give(*mark, 4)
    assert not store.give(*mark, 4)
    with pytest.raises(InputError, match="Another mark is stored"):
        store.give(*mark, 5)
    assert store.marks("R1", trial_id) == {"gears_depth": 4}
    assert rows(study) == 1
    # A correction is a new row, and the latest counts.
    for value in (2, None, 5):
        store.give(str(uuid.uuid4()), "R1", trial_id, OSATS, "osats_flow", value)
    assert store.marks("R1", trial_id) == {"gears_depth": 4, "osats_flow": 5}
    assert rows(study) == 4


@pytest.mark.parametrize(
    ("rater", "domain", "mark", "sentence"),
    [
        ("R1", "gears_autonomy", 3, "GEARS has no domain"),
        ("R1", "gears_depth", 0, "whole number from 1 to 5"),
        ("R2", "gears_depth", 3, "was not given this replay"),
    ],
)
def test_an_invalid_mark_is_refused_with_a_message(study, store, rater, domain, mark, sentence):
    (trial_id, *_) = store.assign("R1", TRIALS, 2, random.Random(1))
    with pytest.raises(InputError, match=sentence):
        store.give(str(uuid.uuid4()), rater, trial_id, GEARS, domain, mark)
    with pytest.raises(InputError, match="The name of a rater must be"):
        store.assign("", TRIALS, 2, random.Random(1))
    assert rows(study) == 0


def test_ratings_are_deleted_with_their_trainee(study, store):
    trial_ids = store.assign("R1", TRIALS, 8, random.Random(1))
    work = RatingWork(store, "R1", trial_ids, (GEARS,))
    while work.go_to_next():
        for _ in GEARS.domains:
            work.give(2)
    study.delete_trainee("T0")
    left = {trial.record.trial_id for name in ("T1", "T2") for trial in study.history(name)}
    assert {rating.trial_id for rating in store.ratings()} == left
    assert rows(study, "rated_replays") == len(left)
