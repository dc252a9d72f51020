"""An aborted step is repeated only with a reason."""

from dataclasses import replace
from datetime import datetime, timezone

import pytest

from rastrainer.errors import InputError
from rastrainer.protocol import REPEAT, StepKind
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from Testing.domain.study.played_study import STUDIES
from Testing.domain.trial.trial_records import gentle_score, make_aborted, make_record

SHIPPED = STUDIES / "published-protocol.json"
REASON = "a phone rang in the middle of it"


@pytest.fixture
def study(study_place):
    with begun(study_place) as study:
        yield study


def begun(place, **changes):
    """Return a study of one task in one mode, in which A is enrolled."""
    study = Study.open(place)
    study.create_trainee("A")
    progress = StudyProgress(study)
    options = {"repetitions": 2, "questionnaires": (), **changes}
    minutes = dict.fromkeys(("trial_run_min", "break_between_tasks_min"), 0.0)
    shipped = StudyProtocol.read(SHIPPED)
    progress.set_protocol(
        replace(shipped, tasks=("task-1",), modes=("desktop",), **minutes, **options)
    )
    progress.enroll("A")
    return study


def abort(study, number, minute, **changes):
    started = f"2999-01-01T10:{minute:02d}:00Z"
    record = make_aborted(number, trainee="A", startedUtc=started, **changes)
    study.add_aborted(record)


def play(study, number, minute):
    started = f"2999-01-01T10:{minute:02d}:00Z"
    trial = make_record(number, trainee="A", startedUtc=started)
    study.add_trial(trial, score=gentle_score(110.0, 0.5))


def test_each_aborted_trial_is_repeated_only_with_its_own_reason(study):
    progress = StudyProgress(study)
    assert progress.progress("A").check_start("desktop", "task-1").kind is StepKind.TRIAL
    abort(study, 900, 1, touches=15)
    standing = progress.progress("A")
    with pytest.raises(InputError, match="aborted with 15 of 15 points touched"):
        standing.check_start("desktop", "task-1")
    assert standing.study_step("A", datetime.now(timezone.utc)).kind == REPEAT
    progress.explain_repeat("A", f"  {REASON} ")
    standing = progress.progress("A")
    assert standing.check_start("desktop", "task-1")
    assert standing.study_step("A", datetime.now(timezone.utc)).kind == StepKind.TRIAL.value
    abort(study, 901, 2)
    with pytest.raises(InputError, match="only with a reason"):
        progress.progress("A").check_start("desktop", "task-1")
    progress.explain_repeat("A", "the headset had lost its tracking")
    first, second = study.aborted("A")
    assert (first.step, first.repeat_reason) == ("desktop/1/task-1", REASON)
    assert second.repeat_reason.startswith("the headset")


def test_a_repeat_counts_only_once_its_reason_is_given(study):
    progress = StudyProgress(study)
    abort(study, 900, 1)
    play(study, 1, 2)
    assert progress.count_played("A").entries == ()
    assert progress.played("A").entries == ()
    progress.explain_repeat("A", REASON)
    assert progress.played("A").next_step.name == "desktop/2/task-1"
    assert progress.count_played("A").next_step.name == "desktop/2/task-1"


def test_an_aborted_trial_belongs_to_one_step_only(study):
    progress = StudyProgress(study)
    play(study, 1, 1)
    assert progress.count_played("A").next_step.name == "desktop/2/task-1"
    abort(study, 900, 0)
    assert not progress.progress("A").unexplained
    abort(study, 901, 2)
    assert [record.elapsed_s for record in progress.progress("A").unexplained] == [60.0]


def test_a_trial_counts_only_with_the_method_that_the_study_asks_for(tmp_path):
    with begun(tmp_path / "study.db", methods={"task-1": "landmarks-surface"}) as study:
        progress = StudyProgress(study)
        play(study, 1, 1)
        assert progress.count_played("A").entries == ()
        trace = [[float(x), 0.0, 0.0, 1.0] for x in range(30)]
        record = make_record(trainee="A", startedUtc="2999-01-01T10:02:00Z")
        record |= {"points": record["points"][:5], "method": "landmarks-surface", "trace": trace}
        study.add_trial(record, score=gentle_score(110.0, 0.5))
        (entry,) = progress.count_played("A").entries
        assert entry.details["trialId"] == record["trialId"]
