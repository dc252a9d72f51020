"""Ratings are stored once, kept, corrected by further rows, and the same trials for all raters."""

import random
import uuid

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.study import Study
from rastrainer.study.ratings import FORMS, GEARS, OSATS, RatingStore
from rastrainer_simulator.rating.rating_work import RatingWork
from Testing.domain.trial.trial_records import make_record

TRIALS = [str(uuid.UUID(int=number)) for number in range(1, 9)]


@pytest.fixture
def study(study_place):
    with Study.open(study_place) as opened:
        for number, trial_id in enumerate(TRIALS):
            trainee = f"T{number % 3}"
            opened.add_trial(make_record(trialId=trial_id, trainee=trainee))
        yield opened


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


def test_a_correction_is_a_new_row_and_the_latest_counts(study, store):
    (trial_id, *_) = store.assign("R1", TRIALS, 2, random.Random(1))
    for mark in (2, None, 5):
        store.give(str(uuid.uuid4()), "R1", trial_id, OSATS, "osats_flow", mark)
    assert store.marks("R1", trial_id) == {"osats_flow": 5}
    assert rows(study) == 3


@pytest.mark.parametrize(
    ("rater", "domain", "mark", "sentence"),
    [
        ("R1", "gears_autonomy", 3, "GEARS has no domain"),
        ("R1", "gears_depth", 0, "whole number from 1 to 5"),
        ("R1", "gears_depth", True, "whole number from 1 to 5"),
        ("R1", "gears_depth", 2.5, "whole number from 1 to 5"),
        ("R2", "gears_depth", 3, "was not given this replay"),
    ],
)
def test_an_invalid_mark_is_refused_with_a_message(study, store, rater, domain, mark, sentence):
    (trial_id, *_) = store.assign("R1", TRIALS, 2, random.Random(1))
    with pytest.raises(InputError, match=sentence):
        store.give(str(uuid.uuid4()), rater, trial_id, GEARS, domain, mark)
    assert rows(study) == 0


def test_an_invalid_pseudonym_is_refused(store):
    with pytest.raises(InputError, match="The name of a rater must be"):
        store.assign("", TRIALS, 2, random.Random(1))


def test_rating_resumes_where_it_stopped_and_is_undone_mark_by_mark(store):
    trial_ids = store.assign("R1", TRIALS, 2, random.Random(1))

    def taken_up():
        return RatingWork(store, "R1", trial_ids, (GEARS, OSATS))

    work = taken_up()
    for mark in (1, 2, 3):
        work.give(mark)
    form, domain = taken_up().open_domain
    assert (form, domain.title) == (GEARS, "Robotic control")
    assert work.undo()
    assert taken_up().open_domain[1].title == "Force sensitivity"
    assert list(work.marks.values()) == [1, 2]
    for mark in (3, 4, 5, 1, 2, 3):
        work.give(mark)
    assert work.open_domain is None
    assert work.rated == 1
    # A ninth mark has no place.
    work.give(5)
    again = taken_up()
    assert again.place == 1
    again.go_back()
    assert again.marks == work.marks
    while again.undo():
        pass
    assert again.marks == {}
    assert again.rated == 0


def test_once_everything_is_rated_there_is_nothing_left_to_do(store):
    trial_ids = store.assign("R1", TRIALS, 3, random.Random(1))
    work = RatingWork(store, "R1", trial_ids, (GEARS,))
    places = []
    while work.go_to_next():
        places.append(work.place)
        for mark in (3, 3, 3, 4):
            work.give(mark)
    assert places == [0, 1, 2]
    assert {rating.trial_id for rating in store.ratings()} == set(trial_ids)
    assert {(rating.form, rating.total) for rating in store.ratings()} == {("gears", 13)}


def test_only_completed_forms_are_ratings(store):
    trial_ids = store.assign("R1", TRIALS, 2, random.Random(1))
    work = RatingWork(store, "R1", trial_ids, (GEARS, OSATS))
    for _ in range(7):
        work.give(3)
    assert [rating.form for rating in store.ratings()] == ["gears"]


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


def test_totals_and_left_out_domains_are_stated():
    for form in FORMS.values():
        assert (form.lowest_total, form.highest_total) == (4, 20)
        assert not set(form.left_out) & {domain.title for domain in form.domains}
        assert form.source
    assert len(GEARS.domains) + len(GEARS.left_out) == 6
    assert len(OSATS.domains) + len(OSATS.left_out) == 7
