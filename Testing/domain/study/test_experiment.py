"""A study's protocol: read with clear errors, balanced, resumed, never skipped silently."""

import itertools
import json
from collections import Counter
from datetime import datetime, timezone
from pathlib import Path

import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.json_records import record_to_json
from rastrainer.protocol import ALL_DONE, DECIDE, FREE, StepKind
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.steps import instruction
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import (
    StudyProtocol,
    protocol_text,
    steps_for,
    williams_design,
)
from rastrainer.study_messages import StudyStep
from Testing.domain.trial.trial_records import gentle_score, make_record

SHIPPED = Path(__file__).parents[3] / "assets" / "studies" / "published-protocol.json"
NOW = datetime(2999, 1, 1, tzinfo=timezone.utc)

LATER = dict.fromkeys(("startedUtc", "completedUtc"), "2999-01-01T10:00:00Z")
"""Times of a trial that starts after its trainee was enrolled."""


def protocol(**changes):
    return StudyProtocol.from_json({**json.loads(SHIPPED.read_text()), **changes})


def trial_of(step, number, trainee="T001"):
    return make_record(number, trainee=trainee, task=step.task, mode=step.mode)


def enrolled(study, **changes):
    """Return the progress of a study in which T001 is enrolled."""
    progress = StudyProgress(study)
    progress.set_protocol(protocol(**changes))
    progress.enroll("T001")
    return progress


@pytest.fixture
def study(study):
    study.create_trainee()
    study.create_trainee()
    return study


@pytest.mark.parametrize("count", range(2, 9))
def test_a_williams_design_is_balanced_for_position_and_predecessor(count):
    design = williams_design(count)
    assert len(design) == (count if count % 2 == 0 else 2 * count)
    assert all(sorted(row) == list(range(count)) for row in design)
    for position in range(count):
        assert len(set(Counter(row[position] for row in design).values())) == 1
    pairs = Counter(pair for row in design for pair in itertools.pairwise(row))
    assert len(pairs) == count * (count - 1)
    assert len(set(pairs.values())) == 1


def test_the_shipped_protocol_is_that_of_the_paper():
    shipped = StudyProtocol.read(SHIPPED)
    steps = steps_for(shipped, 0)
    assert [step.name for step in steps][:4] == [
        "hmd/before/ssq",
        "hmd/trial-run",
        "hmd/1/task-1",
        "hmd/1/task-2",
    ]
    trials = [step for step in steps if step.kind is StepKind.TRIAL]
    assert len(trials) == 10
    assert [step.kind for step in steps].count(StepKind.BREAK) == 1
    assert len({step.name for step in steps}) == len(steps)
    assert instruction(steps[1]) == "Get to know the trial run with the headset for 5 minutes."
    assert instruction(trials[0]) == "Play Task 1 with the headset."
    assert StudyProtocol.from_json(json.loads(protocol_text(shipped))) == shipped


def test_a_trainee_follows_the_steps_and_resumes_after_an_interruption(study_place):
    with Study.open(study_place) as study:
        study.create_trainee()
        progress = StudyProgress(study)
        progress.set_protocol(StudyProtocol.read(SHIPPED))
        assert progress.enroll("T001") == progress.enroll("T001") == 0
        assert progress.progress("T001").sentence == ("Step 1 of 19: Answer the questionnaire SSQ.")
        progress.finish("T001", "hmd/before/ssq", {"answers": [0] * 16})
        progress.practice("T001", "hmd/trial-run", 200.0)
    with Study.open(study_place) as study:
        progress = StudyProgress(study)
        progress.practice("T001", "hmd/trial-run", 100.5)
        assert progress.progress("T001").practiced_s == 300.5
        progress.finish("T001", "hmd/trial-run", {"minutes": 300.5 / 60})
    with Study.open(study_place) as study:
        progress = StudyProgress(study)
        progress.set_protocol(StudyProtocol.read(SHIPPED))
        state = progress.progress("T001")
        assert state.next_step.name == "hmd/1/task-1"
        assert state.check_start("hmd", "task-1") is state.next_step
        with pytest.raises(InputError, match=r"Not yet: .* Step 3 of 19: Play Task 1"):
            state.check_start("desktop", "task-1")
        study.add_trial(trial_of(state.next_step, 1) | LATER, score=gentle_score(110.0, 0.5))
        assert progress.count_played("T001").next_step.name == "hmd/1/task-2"


def test_every_step_survives_the_study_step_command(study):
    progress = enrolled(study, **OPTIONS)
    kinds = set()
    while True:
        step = progress.progress("T001").study_step("T001", NOW)
        checked = check_arguments(
            CommandName.STUDY_STEP, json.loads(json.dumps(record_to_json(step)))
        )
        assert StudyStep(**checked) == step
        kinds.add(step.kind)
        if step.kind == ALL_DONE:
            break
        progress.skip("T001", progress.progress("T001").next_step.name, "only sent in this test")
    assert kinds == {*(kind.value for kind in StepKind), ALL_DONE}
    free = StudyStep("T001", FREE)
    assert StudyStep(**check_arguments(CommandName.STUDY_STEP, record_to_json(free))) == free


OPTIONS = {
    "guidance": "arrow",
    "ghost": "own best",
    "tutorial": "skipped",
    "procedures": {"task-1": "dbs"},
    "methods": {"task-2": "surface", "task-3": "landmarks"},
    "skin": {"task-4": {"shiftMm": 2, "indentationMm": 0.5}, "task-5": {}},
    "drills": ["before-all", "before-mode", "after-all"],
}


def test_drills_come_after_the_questionnaires_of_their_occasion_and_frame_the_study_in_one_mode():
    asked = [{"name": "sus", "when": "before-all"}, {"name": "ssq", "when": "before-mode"}]
    own = protocol(drills=OPTIONS["drills"], questionnaires=asked)
    for place in range(2):
        steps = steps_for(own, place)
        drills = [step for step in steps if step.kind is StepKind.DECIDE]
        assert [step.name for step in steps][:2] == ["before-all/sus", "before-all/decide"]
        assert {(step.task, step.is_played) for step in drills} == {(DECIDE, True)}
        modes = [step.mode for step in drills]
        assert (modes[0], modes[-1], len(modes)) == ("hmd", "hmd", 4)
        first = steps.index(drills[1])
        assert steps[first - 1].questionnaire == "ssq"
        assert steps[first + 1].kind is StepKind.TRIAL_RUN
    assert instruction(drills[0]) == "Do the drill of decisions with the headset."


def test_the_options_of_a_protocol_reach_its_steps():
    assert not OPTIONS.keys() & protocol().to_json().keys()
    own = protocol(**OPTIONS)
    assert StudyProtocol.from_json(json.loads(protocol_text(own))) == own
    steps = steps_for(own, 0)
    runs = [step for step in steps if step.kind is StepKind.TRIAL_RUN]
    assert {(run.guidance, run.ghost, run.tutorial) for run in runs} == {("arrow", "", "skipped")}
    trials = {step.task: step for step in steps if step.kind is StepKind.TRIAL}
    assert {trial.ghost for trial in trials.values()} == {"own best"}
    assert [trial.procedure for trial in trials.values()] == ["dbs", "", "", "", ""]
    methods = ["fiducials", "surface", "landmarks", "fiducials", "fiducials"]
    assert [trial.method for trial in trials.values()] == methods
    told = {task: instruction(trial) for task, trial in trials.items()}
    assert "Task 1 with the procedure dbs" in told["task-1"]
    assert told["task-2"].startswith("Play Task 2 by a trace over the skin ")
    # Trainees are not told about the skin.
    assert told["task-4"] == told["task-5"].replace("Task 5", "Task 4")
    assert trials["task-4"].is_played_on(2.0, 0.5)
    assert not trials["task-4"].is_played_on(0.0, 0.0)
    assert not trials["task-5"].is_played_on(2.0, 0.0)
    assert trials["task-1"].is_played_on(2.0, 0.0)


def test_nothing_is_skipped_silently(study):
    progress = enrolled(study)
    for reason in ("", "   ", "short", None, "x" * 501):
        with pytest.raises(InputError, match="only with a reason"):
            progress.skip("T001", "hmd/before/ssq", reason)
    with pytest.raises(InputError, match="The next step is hmd/before/ssq, not hmd/trial-run"):
        progress.finish("T001", "hmd/trial-run")
    with pytest.raises(InputError, match="The next step is"):
        progress.skip("T001", "hmd/trial-run", "does not want to practice")
    after = progress.skip("T001", "hmd/before/ssq", "questionnaire sheets were missing")
    assert after.next_step.name == "hmd/trial-run"
    assert after.skipped[0].details == {"reason": "questionnaire sheets were missing"}


def test_only_the_right_trial_of_the_right_trainee_counts_and_only_once(study):
    progress = enrolled(study, questionnaires=[], trialRunMin=0, repetitions=2)
    step = progress.progress("T001").next_step
    for other in (
        trial_of(step, 1, trainee="T002"),
        make_record(trainee="T001", task="task-3", mode="hmd"),
    ):
        study.add_trial(other | LATER, score=gentle_score(110.0, 0.5))
        assert progress.count_played("T001").next_step == step
    # A trial without a score completes no step.
    study.add_trial(trial_of(step, 3) | LATER)
    assert progress.count_played("T001").next_step == step
    with pytest.raises(InputError, match="done by a stored trial"):
        progress.finish("T001", step.name, {"trialId": make_record()["trialId"]})
    study.add_trial(trial_of(step, 2) | LATER, score=gentle_score(110.0, 0.5))
    while (again := progress.count_played("T001").next_step).task != "task-1":
        progress.skip("T001", again.name, "only the repeated task matters here")
    assert again.name == "hmd/2/task-1"


def test_a_trial_run_or_a_break_ends_early_only_with_a_reason(study):
    progress = enrolled(study, questionnaires=[])
    for minutes in (None, 4.9, float("nan"), float("inf"), True, "5"):
        with pytest.raises(InputError, match="The trial run takes 5 minutes, of which"):
            progress.finish("T001", "hmd/trial-run", {"minutes": minutes})
    assert progress.skip("T001", "hmd/trial-run", "has practiced in a pilot").skipped
    with pytest.raises(InputError, match="not the next step, or not a trial run"):
        progress.practice("T001", "hmd/trial-run", 1.0)


def test_trials_are_counted_automatically_in_protocol_order_since_enrollment(study):
    progress = StudyProgress(study)
    progress.set_protocol(protocol(questionnaires=[], trialRunMin=0, repetitions=2))
    first = steps_for(progress.protocol(), 0)[0]
    study.add_trial(trial_of(first, 1), score=gentle_score(110.0, 0.5))
    progress.enroll("T001")
    assert progress.count_played("T001").entries == ()

    def play(number, task, minute):
        utc = f"2999-01-01T10:{minute:02d}:00Z"
        trial = trial_of(first, number) | {"task": task, "startedUtc": utc, "completedUtc": utc}
        study.add_trial(trial, score=gentle_score(110.0, 0.5))

    # Not delivered in the order played; a task played twice does not make a second round.
    play(3, "task-2", 20)
    play(4, "task-1", 15)
    play(2, "task-1", 10)
    counted = progress.count_played("T001")
    assert [trial[-1] for trial in counted.counted_trials] == ["2", "3"]
    assert counted.next_step.name == "hmd/1/task-3"
    assert progress.count_played("T001") == counted
    for name in ("hmd/1/task-3", "hmd/1/task-4", "hmd/1/task-5"):
        progress.skip("T001", name, "the power had failed for the day")
    assert progress.count_played("T001").next_step.name == "hmd/2/task-1"


def test_the_protocol_of_a_running_study_cannot_change(study):
    progress = StudyProgress(study)
    assert progress.protocol() is None
    with pytest.raises(InputError, match="no protocol yet"):
        progress.enroll("T001")
    progress.set_protocol(protocol())
    with pytest.raises(InputError, match="started with another protocol"):
        progress.set_protocol(protocol(repetitions=2))
    with pytest.raises(InputError, match="not enrolled"):
        progress.progress("T002")


def test_the_sequence_number_of_a_deleted_trainee_is_reused(study):
    progress = StudyProgress(study)
    progress.set_protocol(protocol())
    assert (progress.enroll("T001"), progress.enroll("T002")) == (0, 1)
    progress.skip("T001", "hmd/before/ssq", "left before it began")
    study.delete_trainee("T001")
    study.create_trainee("T009")
    assert progress.enroll("T009") == 0
    assert progress.progress("T009").entries == ()
    assert progress.enrolled() == {"T009": 0, "T002": 1}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"tasks": ["trial-run"]}, "the trial run and the drill of decisions are none"),
        ({"questionnaires": [{"name": "mmpi", "when": "after-all", "modes": []}]}, "there are sus"),
        ({"references": {"task-9": {"timeS": 100, "treMm": 1}}}, "references.task-9 must be one"),
        ({"taskorder": "fixed"}, 'there is no "taskorder"; use name, title'),
    ],
)
def test_an_invalid_protocol_is_refused_in_one_sentence_that_names_the_field(
    change, words, tmp_path
):
    path = tmp_path / "protocol.json"
    path.write_text(json.dumps({**json.loads(SHIPPED.read_text()), **change}))
    with pytest.raises(InputError, match=words) as caught:
        StudyProtocol.read(path)
    assert "\n" not in str(caught.value)
