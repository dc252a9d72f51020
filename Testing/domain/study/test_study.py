"""The study stores trials once and completely, until their trainee is deleted."""

import json
import uuid
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json
from rastrainer.registration.fits import KINDS
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import target_error
from rastrainer.study.database.schema import TABLES
from rastrainer.study.database.study import DeletedTrialError, Study
from rastrainer.study.database.values import StoredRegistration
from rastrainer.study.trainee_data import export_trainee
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.record import TrialRecord
from Testing.domain.trial.trial_records import gentle_score, make_record

TRUTH = RevealedTruth(tuple(np.eye(4).ravel().tolist()), 0.5)


@pytest.fixture
def results(touched_head):
    moving, fixed, _ = touched_head(0)
    registrations = [register(moving, fixed, kind) for kind in KINDS]
    errors = {r.kind: target_error(r, [0.0, 10.0, 20.0]) for r in registrations}
    score = gentle_score(110.0, errors["rigid"].expected_mm)
    return registrations, errors, score


def test_outcomes_are_those_of_one_task_and_mode_with_the_latest_score(study, results):
    study.add_trial(make_record(1), *results)
    study.add_trial(make_record(2, trainee="b", completionTimeS=90.0))
    study.add_trial(make_record(3, mode="hmd"))
    study.add_trial(make_record(4, task="task-2"))
    study.add_results(make_record(1)["trialId"], truth=TRUTH)
    better = gentle_score(50.0, 0.2)
    study.add_results(make_record(1)["trialId"], score=better)
    # Only the numbers are read, no JSON: there may be thousands.
    study.database.change("UPDATE results SET result_json = '{}'")
    first, second = study.outcomes("task-1", "desktop")
    time_s = {"completion_time_s": first.values["completion_time_s"]}
    assert first.trainee == "T-001"
    assert first.values == {**time_s, "score": better.score, "true_tre_mm": 0.5}
    assert (second.trainee, second.values) == ("b", {"completion_time_s": 90.0})
    assert first.method == second.method == "fiducials"


def test_pseudonyms_are_proposed_and_never_reused(study):
    assert [study.create_trainee().pseudonym for _ in range(3)] == ["T001", "T002", "T003"]
    study.delete_trainee("T003")
    study.create_trainee("T005")
    assert study.create_trainee().pseudonym == "T006"
    with pytest.raises(InputError, match='"T005" is taken'):
        study.create_trainee("T005")


@pytest.mark.parametrize("name", ["", "T-001 ", "a\n", "T\u202e1", "x" * 65])
def test_a_trial_with_an_invalid_pseudonym_is_refused(study, name):
    with pytest.raises(InputError):
        study.create_trainee(name)
    with pytest.raises(InputError):
        study.add_trial(make_record(trainee=name))
    assert study.trainees() == ()


def test_only_changed_trials_are_read_again(study, study_place, monkeypatch):
    read, find = [], study.trial

    def watched(trial_id):
        read.append(trial_id)
        return find(trial_id)

    monkeypatch.setattr(study, "trial", watched)
    trials = [str(uuid.UUID(int=number)) for number in (1, 2)]
    for number in (1, 2):
        study.add_trial(make_record(number))
    study.history("T-001")
    assert sorted(read) == trials
    read.clear()
    study.history("T-001")
    assert read == []
    with Study.open(study_place) as other:
        other.add_results(trials[1], truth=TRUTH)
        other.add_results(trials[0], score=gentle_score(50.0, 0.2))
    stored = {trial.record.trial_id: trial for trial in study.history("T-001")}
    assert sorted(read) == trials
    assert stored[trials[1]].true_tre_mm == 0.5
    assert stored[trials[0]].score == gentle_score(50.0, 0.2)
    study.delete_trainee("T-001")
    study.create_trainee("T-001")
    assert study.history("T-001") == ()


def test_a_trial_is_stored_with_all_its_results(study, results):
    registrations, errors, score = results
    delivered = make_record(weather="fine")
    assert study.add_trial(delivered, registrations, errors, score)
    stored = study.trial(delivered["trialId"])
    assert stored.record == record_from_json(TrialRecord, delivered)
    assert stored.registrations == {
        r.kind: StoredRegistration.of(r, errors[r.kind]) for r in registrations
    }
    assert stored.registrations["rigid"].fre_mm == registrations[0].fre_mm
    assert stored.score == score
    assert stored.true_tre_mm is None


def test_a_trial_delivered_twice_is_stored_once_and_another_of_its_uuid_refused(study, results):
    assert study.add_trial(make_record(), *results)
    assert not study.add_trial(make_record(seed=None))
    assert not study.add_trial(record_from_json(TrialRecord, make_record()))
    with pytest.raises(InputError, match="Another trial is stored"):
        study.add_trial(make_record(completionTimeS=1.0))
    (stored,) = study.history("T-001")
    assert (stored.score, stored.record.completion_time_s) == (results[2], 110.0)
    # An unknown trainee was added, so that no trial is lost.
    assert not study.trainee("T-001").consent


@pytest.mark.parametrize(
    ("bad", "words"),
    [
        ({}, "needs the key"),
        (make_record(extra=float("nan")), "must be JSON with finite numbers"),
        (make_record(extra="a\\\0b"), "whole characters, none of them null"),
        (make_record(extra="x" * 2**20), "larger than 1 MiB"),
    ],
)
def test_an_invalid_record_is_refused_and_not_stored(bad, words, study):
    with pytest.raises(InputError, match=words):
        study.add_trial(bad)
    assert study.trainees() == ()


def test_the_latest_results_count_and_earlier_ones_remain(study, results):
    registrations, errors, score = results
    study.add_trial(make_record(), registrations, errors, score)
    fewer = registrations[0].without("3")
    better = gentle_score(50.0, 0.2)
    study.add_results(make_record()["trialId"], [fewer], score=better)
    stored = study.trial(make_record()["trialId"])
    assert "3" not in stored.registrations["rigid"].labels
    assert stored.registrations["rigid"].expected_tre_mm is None
    assert stored.registrations["affine"].fre_mm == registrations[2].fre_mm
    assert stored.score == better
    query = "SELECT count(*) FROM results GROUP BY kind = 'score' ORDER BY 1"
    assert study.database.rows(query) == [(2,), (4,)]


def test_the_truth_is_stored_once(study):
    first, second = make_record(1), make_record(2)
    study.add_trial(first)
    study.add_trial(second)
    study.add_results(first["trialId"], truth=TRUTH)
    study.add_results(first["trialId"], truth=replace(TRUTH, true_tre_mm=9.0))
    stored = study.trial(first["trialId"])
    assert stored.truth == TRUTH
    assert [r.trial_id for r in study.unrevealed()] == [second["trialId"]]
    with pytest.raises(InputError, match="finite"):
        study.add_results(second["trialId"], truth=replace(TRUTH, true_tre_mm=float("nan")))


def test_deleting_a_trainee_leaves_no_row_and_no_byte_of_theirs(study, study_place, results):
    study.add_trial(make_record(1, trainee="Vanishing Heron"), *results)
    study.add_results(make_record(1)["trialId"], truth=TRUTH)
    study.add_trial(make_record(2, trainee="staying"), *results)
    assert study.delete_trainee("Vanishing Heron") == 1
    if isinstance(study_place, Path):
        content = study_place.read_bytes()
        assert b"Vanishing Heron" not in content
        assert make_record(1)["trialId"].encode() not in content
        assert list(study_place.parent.iterdir()) == [study_place]
    for table in TABLES.values():
        rows = str(study.database.rows(f"SELECT * FROM {table.name}"))
        assert "Vanishing Heron" not in rows
        assert make_record(1)["trialId"] not in rows
    assert len(study.history("staying")) == 1
    assert study.trial(make_record(2)["trialId"]).score == results[2]


def test_a_deleted_trial_that_is_offered_again_is_refused(study, study_place):
    study.add_trial(make_record(1, trainee="gone"))
    study.delete_trainee("gone")
    with pytest.raises(DeletedTrialError, match="deleted from the study"):
        study.add_trial(make_record(1, trainee="gone"))
    assert study.trainees() == ()
    with Study.open(study_place) as again, pytest.raises(DeletedTrialError):
        again.add_trial(make_record(1, trainee="gone"))
    assert study.add_trial(make_record(2, trainee="gone"))


def test_everything_about_one_trainee_is_exported_and_nothing_about_others(
    study, results, tmp_path
):
    first = make_record(1, trainee="a", motion={"path_mm": 2500.5})
    study.add_trial(first, *results)
    study.add_results(make_record(1)["trialId"], truth=TRUTH)
    study.add_trial(make_record(2, trainee="b"))
    assert export_trainee(study, "a", tmp_path / "a.json") == 1
    text = (tmp_path / "a.json").read_text()
    (trial,) = json.loads(text)["trials"]
    assert record_from_json(TrialRecord, trial["record"]) == record_from_json(TrialRecord, first)
    assert (trial["truth"]["trueTreMm"], trial["record"]["motion"]) == (0.5, {"path_mm": 2500.5})
    assert make_record(2)["trialId"] not in text
