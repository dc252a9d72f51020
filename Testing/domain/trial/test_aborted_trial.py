"""An aborted trial is stored as delivered, counts as an attempt, and can be deleted."""

import json

import pytest

from rastrainer.errors import InputError
from rastrainer.study.database.schema import TABLES
from rastrainer.study.database.study import DeletedTrialError
from rastrainer.study.trainee_data import erase_trainee, export_trainee
from rastrainer.trial.scoring import passes
from rastrainer.trial.trial_feedback import progress_of
from Testing.domain.trial.trial_records import gentle_score, make_aborted, make_record


def test_an_aborted_trial_is_stored_once(study):
    assert study.add_aborted(make_aborted())
    assert not study.add_aborted(make_aborted())
    assert len(study.aborted("T-001")) == 1
    assert not study.trainee("T-001").consent
    assert study.history("T-001") == ()
    study.add_trial(make_record())
    for other in (make_aborted(elapsedS=3.0), make_aborted(number=7)):
        with pytest.raises(InputError, match="Another trial is stored"):
            study.add_aborted(other)


def test_aborted_trials_are_exported_and_deleted_with_their_trainee(study, tmp_path):
    study.add_aborted(make_aborted())
    assert export_trainee(study, "T-001", tmp_path / "all.json") == 0
    (exported,) = json.loads((tmp_path / "all.json").read_text())["abortedTrials"]
    assert (exported["record"]["reason"], len(exported["record"]["points"])) == ("trainee", 3)
    assert (exported["step"], exported["repeatReason"]) == ("", "")
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


@pytest.mark.parametrize(
    ("changes", "counts"),
    [
        pytest.param({}, True, id="touched"),
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


def test_aborting_bad_trials_does_not_help_to_show_competence(study):
    score = gentle_score(110.0, 0.4)
    for number in range(24):
        utc = f"2024-05-17T{10 + number // 2}:{30 * (number % 2):02d}:00Z"
        if number % 2:
            study.add_aborted(make_aborted(number=number + 500, touches=15, startedUtc=utc))
        else:
            study.add_trial(make_record(number, startedUtc=utc), score=score)
    attempts = study.attempts("T-001")
    finished = [attempt for attempt in attempts if not attempt.is_aborted]
    last = finished[-1].trial_id
    assert progress_of(finished, last, 10.0).sentences[2].key == "competent"
    assert progress_of(attempts, last, 10.0).sentences[2].key == "not competent"
