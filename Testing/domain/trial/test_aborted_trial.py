"""An aborted trial is stored as delivered, counts as an attempt, and can be deleted."""

import json

import pytest

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import RegistrationMethod
from rastrainer.study.database.schema import TABLES
from rastrainer.study.database.study import DeletedTrialError, Study
from rastrainer.study.trainee_data import erase_trainee, export_trainee
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.scoring import passes
from rastrainer.trial.trial_feedback import competence_of, progress_of
from Testing.domain.trial.trial_records import gentle_score, make_aborted, make_record


@pytest.fixture
def study(study_place):
    with Study.open(study_place) as study:
        yield study


def test_a_record_survives_json():
    for touches in (0, 3, 15):
        record = record_from_json(AbortedTrial, make_aborted(touches=touches))
        assert (
            record_from_json(AbortedTrial, json.loads(json.dumps(record_to_json(record)))) == record
        )
        assert record.is_after_all_touches == (touches == 15)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        pytest.param({"phase": "scored"}, "phase must be one of running", id="phase"),
        pytest.param({"points": make_record()["points"][:1] * 2}, "holds the label", id="twice"),
        pytest.param({"points": make_record()["points"][1::-1]}, "in the order", id="order"),
    ],
)
def test_an_invalid_record_is_refused_with_a_message_and_not_stored(study, change, words):
    with pytest.raises(InputError, match=words):
        study.add_aborted(make_aborted(**change))
    assert study.trainees() == ()


def test_a_too_large_record_and_another_name_for_a_trainee_are_refused(study):
    with pytest.raises(InputError, match="larger than 1 MiB"):
        study.add_aborted(make_aborted(more="x" * 2**20))
    with pytest.raises(InputError, match="pseudonym"):
        study.add_aborted(make_aborted(trainee=" T"))
    assert study.trainees() == ()


def test_an_aborted_trial_is_stored_once(study):
    assert study.add_aborted(make_aborted())
    assert not study.add_aborted(make_aborted())
    assert len(study.aborted("T-001")) == 1
    assert not study.trainee("T-001").consent
    with pytest.raises(InputError, match="Another trial is stored"):
        study.add_aborted(make_aborted(elapsedS=3.0))


def test_finished_and_aborted_trials_have_different_uuids(study):
    study.add_trial(make_record())
    with pytest.raises(InputError, match="Another trial is stored"):
        study.add_aborted(make_aborted(number=7))


def test_an_aborted_trial_is_not_listed_as_finished(study):
    study.add_aborted(make_aborted())
    assert study.history("T-001") == ()


def test_deleting_a_trainee_deletes_aborted_trials_for_good(study, tmp_path):
    study.add_aborted(make_aborted())
    records = tmp_path / "records"
    records.mkdir()
    erased = erase_trainee(study, "T-001", records)
    assert erased.trials == 0
    assert erased.missing == (make_aborted()["trialId"],)
    with pytest.raises(DeletedTrialError):
        study.add_aborted(make_aborted())
    for table in TABLES.values():
        rows = str(study.database.rows(f"SELECT * FROM {table.name}"))
        assert "T-001" not in rows
        assert make_aborted()["trialId"] not in rows


def test_the_export_of_a_trainee_has_the_aborted_trials(study, tmp_path):
    study.add_aborted(make_aborted())
    assert export_trainee(study, "T-001", tmp_path / "all.json") == 0
    exported = json.loads((tmp_path / "all.json").read_text())["abortedTrials"]
    assert [(each["record"]["reason"], len(each["record"]["points"])) for each in exported] == [
        ("trainee", 3)
    ]


@pytest.mark.parametrize(
    ("changes", "counts"),
    [
        pytest.param({}, True, id="touched"),
        pytest.param({"touches": 15}, True, id="all-touched"),
        pytest.param({"touches": 0, "undoneTouches": 2}, True, id="undone"),
        pytest.param({"touches": 0}, False, id="only-refused"),
        pytest.param({"task": "trial-run"}, False, id="trial-run"),
    ],
)
def test_an_aborted_trial_of_a_scored_task_with_a_touch_counts_as_not_passed(
    study, changes, counts
):
    study.add_aborted(make_aborted(**changes))
    attempts = study.attempts("T-001")
    assert [attempt.is_aborted for attempt in attempts] == [True] * counts
    assert not any(passes(each.score, each.acceptable, 0.0) for each in attempts)


def test_attempts_are_in_order_of_starting(study):
    score = gentle_score(110.0, 0.5)
    for number, minute in ((1, 10), (2, 30)):
        utc = f"2024-05-17T09:{minute}:00Z"
        record = make_record(trialId=f"00000000-0000-0000-0000-00000000000{number}", startedUtc=utc)
        study.add_trial(record, score=score)
    study.add_aborted(make_aborted(startedUtc="2024-05-17T09:20:00+00:00"))
    attempts = study.attempts("T-001")
    assert [attempt.is_aborted for attempt in attempts] == [False, True, False]
    standing = progress_of(attempts, attempts[-1].trial_id, 10.0)
    assert len(standing.scores) == 2
    assert standing.competence.scores == competence_of([False, True, False]).scores
    with pytest.raises(InputError):
        progress_of(attempts, attempts[1].trial_id, 10.0)


def test_aborting_bad_trials_does_not_help_to_show_competence(study):
    score = gentle_score(110.0, 0.4)
    for number in range(24):
        utc = f"2024-05-17T{10 + number // 2}:{30 * (number % 2):02d}:00Z"
        trial_id = f"00000000-0000-0000-0000-0000000000{number:02d}"
        if number % 2:
            study.add_aborted(make_aborted(number=number + 500, touches=15, startedUtc=utc))
        else:
            study.add_trial(make_record(trialId=trial_id, startedUtc=utc), score=score)
    attempts = study.attempts("T-001")
    finished = [attempt for attempt in attempts if not attempt.is_aborted]
    last = finished[-1].trial_id
    assert progress_of(finished, last, 10.0).competence.competent_at is not None
    assert progress_of(attempts, last, 10.0).competence.competent_at is None


def test_an_aborted_trial_keeps_its_method_and_older_records_default_to_fiducials():
    assert (
        not {"method", "traced"}
        & record_to_json(record_from_json(AbortedTrial, make_aborted())).keys()
    )
    given = make_aborted(touches=3, method="surface", traced=41)
    record = record_from_json(AbortedTrial, given)
    assert (record.method, record.traced) == (RegistrationMethod.SURFACE, 41)
    assert record_to_json(record) == given
