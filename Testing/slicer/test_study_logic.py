"""The study leads each trainee: the next step, its time, its questionnaires, and resuming."""

import json
from datetime import datetime, timedelta, timezone
from pathlib import Path

import pytest

from rastrainer.errors import InputError
from rastrainer.protocol import StepKind
from rastrainer.sections.study_logic import StudyLogic
from rastrainer.sections.trainees_logic import TraineeLogic
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import moment
from rastrainer.study.protocol.study_progress import StudyProgress
from Testing.domain.trial.trial_records import gentle_score, make_aborted

SHIPPED = Path(__file__).parents[2] / "assets" / "studies" / "published-protocol.json"
STARTED = "2999-01-01T10:00:00Z"


class Lab:
    """A study with a protocol, its trainee, and an instructor."""

    def __init__(self, room, folder):
        self.room, self.path = room, folder / "study.db"
        self.moment = datetime.now(timezone.utc)
        self.trainees = TraineeLogic(lambda: Study.open(self.path), folder / "journals")
        self.logic = StudyLogic(self.trainees, room.logic, room.link, lambda: self.moment)

    def close(self):
        self.logic.close()
        self.trainees.close()

    @property
    def next(self):
        return self.logic.progress().next_step.name

    @property
    def played(self):
        status = self.room.logic.status
        return status.method, status.procedure.name

    def begin(self, **changes):
        """Begin a study by the published protocol with changes, and enroll the trainee."""
        path = self.path.with_name("protocol.json")
        path.write_text(json.dumps(json.loads(SHIPPED.read_text()) | changes))
        self.logic.begin(path)
        self.logic.enroll()

    def skip(self, reason):
        self.logic.skipStep(self.next, reason)

    def spend_in_step(self, minutes):
        """Set the clock to a time after the step has begun, however long the machine took."""
        since = moment(self.logic.progress().since_utc)
        self.moment = since + timedelta(minutes=minutes)

    def practice(self, seconds, **changes):
        """Play a trial run for a time, with a pause in it, and end it."""
        self.tell(phase="running", elapsedS=0.0, **changes)
        self.tell(phase="running", elapsedS=seconds / 2, **changes)
        self.tell(phase="paused", elapsedS=seconds, **changes)
        self.room.now += 1000.0
        self.tell(phase="idle", elapsedS=0.0)

    def reconnect(self, count=1):
        """Lose the simulator and find it again; return the `count` steps that it is sent then."""
        before = len(self.room.sent("StudyStep"))
        self.room.link.disconnect()
        self.room.link.connectTo(port=self.room.simulator.port)
        self.room.run_until(lambda: len(self.room.sent("StudyStep")) >= before + count)
        return self.room.all_sent("StudyStep")[before:]

    def tell(self, **changes):
        """Have the simulator send the state of a trial, and wait until the logic has it."""
        state = {"trainee": "T001", "task": "trial-run", "mode": "hmd", **changes}
        self.room.tell(**state)
        self.room.run_until(lambda: state.items() <= vars(self.room.logic.status).items())


@pytest.fixture
def lab(room, tmp_path):
    lab = Lab(room, tmp_path)
    lab.trainees.create("T001", consent=True)
    yield lab
    lab.close()


@pytest.fixture
def enrolled(lab):
    lab.logic.begin(SHIPPED)
    assert lab.logic.enroll() == 0
    return lab


@pytest.fixture
def practicing(enrolled):
    """A trainee whose next step is the trial run."""
    enrolled.logic.answer([0] * 16)
    return enrolled


@pytest.fixture
def played(make_record):
    """The first trial of the published protocol, with its score."""
    record = make_record(
        "00000000-0000-0000-0000-000000000001",
        trainee="T001",
        mode="hmd",
        startedUtc=STARTED,
        completedUtc=STARTED,
    )
    return {"trial": record, "score": gentle_score(110.0, 0.5)}


def test_in_a_study_with_a_protocol_only_enrolled_trainees_start_trials(lab):
    assert (lab.logic.study.protocol(), lab.logic.progress()) == (None, None)
    lab.logic.startTrial("task-2", "desktop")
    lab.room.run_until(lambda: lab.room.sent("StartTask"))
    lab.logic.begin(SHIPPED)
    with pytest.raises(InputError, match="Enroll the trainee"):
        lab.logic.startTrial("task-1", "hmd")


def test_the_study_starts_only_what_comes_next(enrolled):
    logic, room = enrolled.logic, enrolled.room
    with pytest.raises(InputError, match="Answer the questionnaire SSQ"):
        logic.startStep()
    with pytest.raises(InputError, match="16 answers"):
        logic.answer([0] * 15)
    logic.answer([0] * 16)
    with pytest.raises(InputError, match=r"Not yet: .*trial run with the headset"):
        logic.startTrial("task-1", "desktop")
    room.needsTutorial = True
    logic.startStep()
    logic.startTrial("trial-run", "hmd", isTutorialFirst=False)
    # A received command is not answered yet: the answer is set below.
    room.run_until(lambda: len(room.answers) == 2)
    assert room.logic.learner == "T001"
    assert len(room.sent("StartTutorial")) == 2
    assert room.all_sent("StartTask") == [], "within a study, its protocol decides"
    room.needsTutorial = False
    logic.startStep()
    room.run_until(lambda: room.sent("StartTask"))
    assert room.sent("StartTask") == [{"task": "trial-run", "trainee": "T001", "mode": "hmd"}]


def test_the_elapsed_time_of_a_trial_run_survives_an_interruption(practicing, tmp_path):
    practicing.practice(120.0)
    practicing.close()
    again = Lab(practicing.room, tmp_path)
    again.trainees.choose("T001")
    assert again.logic.minutesElapsed(again.logic.progress()) == 2.0
    again.practice(179.0)
    assert again.next == "hmd/trial-run"
    again.practice(1.0)
    assert again.next == "hmd/1/task-1"
    again.close()


def test_the_trial_run_ends_by_itself_while_it_is_played(practicing):
    practicing.tell(phase="idle")
    practicing.tell(phase="running", elapsedS=2.5)
    practicing.tell(phase="running", elapsedS=299.9)
    assert practicing.next == "hmd/trial-run"
    practicing.tell(phase="running", elapsedS=300.0)
    assert practicing.next == "hmd/1/task-1"
    assert practicing.logic.progress().entries[-1].details == {"minutes": 5.0}


def test_each_trial_run_counts_from_its_start_the_first_from_when_this_slicer_connected(practicing):
    practicing.tell(phase="running", elapsedS=250.0)
    practicing.tell(phase="running", elapsedS=280.0)
    assert practicing.logic.minutesElapsed(practicing.logic.progress()) == 0.5
    practicing.tell(phase="running", elapsedS=30.0, trialId="another")
    practicing.tell(phase="running", elapsedS=40.0, trialId="another")
    practicing.tell(phase="idle", elapsedS=0.0)
    assert practicing.logic.progress().practiced_s == pytest.approx(30.0 + 40.0)


def test_practice_of_another_trainee_or_task_does_not_count(practicing):
    for other in ({"trainee": "T002"}, {"task": "task-1"}, {"mode": "desktop"}):
        practicing.practice(600.0, **other)
    practicing.practice(6.0)
    assert practicing.logic.minutesElapsed(practicing.logic.progress()) == pytest.approx(0.1)


def test_a_break_ends_after_the_protocols_minutes_which_a_later_simulator_is_told(lab):
    lab.begin(tasks=["task-1"], questionnaires=[], trialRunMin=0)
    lab.skip("the headset's battery was empty")
    assert lab.next == "desktop/break"
    lab.room.run_until(lambda: sent_step(lab).get("minutes") == 10.0)
    lab.spend_in_step(4.0)
    (again,) = lab.reconnect()
    assert again["minutes"] == 10.0
    assert again["over"] == pytest.approx(4.0, abs=0.5)
    lab.spend_in_step(9.9)
    lab.trainees.choose("")
    lab.logic.process()
    lab.trainees.choose("T001")
    assert lab.next == "desktop/break"
    lab.moment += timedelta(minutes=0.2)
    lab.logic.process()
    entry = lab.logic.progress().entries[-1]
    assert (entry.outcome, round(entry.details["minutes"], 1)) == ("done", 10.1)
    assert lab.next == "desktop/1/task-1"


def test_a_trial_that_will_not_count_is_reported_while_it_is_played(practicing):
    practicing.tell(phase="running", task="task-3")
    said = practicing.logic.offProtocolSentence()
    assert "task-3 by fiducials in the mode hmd, which the study does not ask for" in said
    practicing.tell(phase="running", task="trial-run")
    assert practicing.logic.offProtocolSentence() == ""
    practicing.tell(phase="running", trainee="somebody", task="task-3")
    assert practicing.logic.offProtocolSentence() == ""


def test_a_break_that_another_slicer_has_ended_ends_no_other_step(lab):
    lab.begin(tasks=["task-1"], questionnaires=[], trialRunMin=5)
    while lab.next != "desktop/break":
        lab.skip("this is not what is tested")
    lab.trainees.choose("")
    with Study.open(lab.path) as elsewhere:
        StudyProgress(elsewhere).skip("T001", "desktop/break", "the trainee wants to continue")
    lab.moment = datetime.now(timezone.utc) + timedelta(hours=1)
    lab.logic.process()
    lab.trainees.choose("T001")
    assert lab.next == "desktop/trial-run"


def test_practice_before_switching_studies_counts_only_in_the_former_study(practicing):
    practicing.tell(phase="running", elapsedS=0.0)
    practicing.tell(phase="running", elapsedS=3.0)
    former = practicing.path
    practicing.logic.leaveStudy()
    practicing.path = former.with_name("other.db")
    practicing.trainees.reopen()
    practicing.trainees.create("T001", consent=True)
    practicing.logic.begin(SHIPPED)
    practicing.logic.enroll()
    practicing.logic.answer([0] * 16)
    practicing.tell(phase="running", elapsedS=4.0)
    practicing.tell(phase="idle", elapsedS=0.0)
    assert practicing.logic.progress().practiced_s == 0.0
    with Study.open(former) as study:
        assert StudyProgress(study).progress("T001").practiced_s == pytest.approx(3.0)


def sent_step(lab):
    """The last step that was sent to the simulator; empty before."""
    steps = lab.room.sent("StudyStep")
    return steps[-1] if steps else {}


def test_the_simulator_is_sent_the_next_step_whenever_it_changes(enrolled):
    room = enrolled.room
    room.run_until(lambda: sent_step(enrolled).get("questionnaire") == "ssq")
    enrolled.logic.answer([0] * 16)
    room.run_until(lambda: sent_step(enrolled)["kind"] == "trial-run")
    assert sent_step(enrolled) == {
        "trainee": "T001",
        "kind": "trial-run",
        "number": 2,
        "count": 19,
        "task": "trial-run",
        "mode": "hmd",
        "minutes": 5.0,
    }
    count = len(room.sent("StudyStep"))
    enrolled.trainees.changed.emit()
    enrolled.skip("has practiced in the pilot")
    room.run_until(lambda: sent_step(enrolled)["kind"] == "trial")
    assert len(room.sent("StudyStep")) == count + 1


def test_a_reconnected_simulator_is_sent_the_steps_of_all_trainees(enrolled):
    enrolled.trainees.create("T002", consent=True)
    enrolled.logic.enroll()
    enrolled.room.run_until(lambda: sent_step(enrolled).get("trainee") == "T002")
    assert sorted(step["trainee"] for step in enrolled.reconnect(2)) == ["T001", "T002"]


def test_a_deleted_trainee_is_no_longer_in_the_study(enrolled):
    enrolled.room.run_until(lambda: sent_step(enrolled))
    enrolled.trainees.delete()
    enrolled.room.run_until(lambda: sent_step(enrolled) == {"trainee": "T001", "kind": "free"})


def test_a_late_trial_counts_before_the_next_step_is_sent(practicing, played, tmp_path):
    practicing.skip("has practiced in the pilot")
    practicing.trainees.choose("")
    practicing.room.run_until(lambda: sent_step(practicing).get("task") == "task-1")
    with Study.open(tmp_path / "study.db") as elsewhere:
        elsewhere.add_trial(played["trial"], score=played["score"])
    assert [step["task"] for step in practicing.reconnect()] == ["task-2"]


def answered(lab, **changes):
    """Have the simulator send answers."""
    answers = {"trainee": "T001", "number": 1, "questionnaire": "ssq", "answers": [1] * 16}
    lab.room.simulator.send_command("StepAnswered", {**answers, **changes})


def test_answers_given_at_the_simulator_are_stored_once_for_whichever_trainee_is_chosen(enrolled):
    enrolled.trainees.choose("")
    answered(enrolled)
    answered(enrolled, answers=[3] * 16)
    enrolled.room.run_until(lambda: sent_step(enrolled).get("kind") == "trial-run")
    answered(enrolled, answers=[3] * 16)
    # The first step, and the next one after each answer.
    enrolled.room.run_until(lambda: len(enrolled.room.sent("StudyStep")) == 4)
    (kept,) = StudyProgress(enrolled.trainees.study).answers()
    assert (kept.trainee, kept.step.name, kept.answers) == ("T001", "hmd/before/ssq", (1,) * 16)
    assert sent_step(enrolled)["kind"] == "trial-run"


def test_answers_that_do_not_belong_to_the_step_are_not_stored(enrolled):
    for wrong in (
        {"answers": [1] * 15},
        {"answers": [4] * 16},
        {"answers": 7},
        {"trainee": ["T001"]},
        {"number": 2},
        {"questionnaire": "sus", "answers": [1] * 10},
        {"questionnaire": "dance"},
    ):
        answered(enrolled, **wrong)
        enrolled.tell(phase="running")
        enrolled.tell(phase="idle")
        assert enrolled.next == "hmd/before/ssq", wrong


def test_the_simulator_waits_until_an_aborted_trial_has_its_reason(enrolled):
    while enrolled.logic.progress().next_step.kind is not StepKind.TRIAL:
        enrolled.skip("this is not what is tested")
    step = enrolled.logic.progress().next_step
    started = datetime.now(timezone.utc).isoformat()
    aborted = make_aborted(trainee="T001", mode=step.mode, task=step.task, startedUtc=started)
    enrolled.trainees.study.add_aborted(aborted)
    enrolled.logic.leadOn("T001")
    room = enrolled.room
    room.run_until(lambda: sent_step(enrolled).get("kind") == "repeat")
    assert sent_step(enrolled)["task"] == step.task
    for start in (
        enrolled.logic.startStep,
        lambda: enrolled.logic.startTrial(step.task, step.mode),
    ):
        with pytest.raises(InputError, match="only with a reason"):
            start()
    enrolled.tell(phase="running", mode=step.mode, task=step.task)
    assert "once a reason is given" in enrolled.logic.offProtocolSentence()
    with pytest.raises(InputError, match="10 to 500"):
        enrolled.logic.explainRepeat("because")
    enrolled.logic.explainRepeat("the fire alarm went off")
    room.run_until(lambda: sent_step(enrolled)["kind"] == "trial")
    assert enrolled.logic.offProtocolSentence() == ""


def test_a_study_trial_is_started_with_method_procedure_and_skin_of_its_protocol(lab):
    skin = {"shiftMm": 2.0, "indentationMm": 0.0}
    methods, procedures = {"task-1": "landmarks-surface"}, {"task-1": "dbs"}
    which = {"methods": methods, "procedures": procedures, "skin": {"task-1": skin}}
    lab.begin(modes=["desktop"], tasks=["task-1"], questionnaires=[], trialRunMin=0, **which)
    assert "by landmarks and a trace" in lab.logic.progress().sentence
    lab.room.run_until(lambda: sent_step(lab).get("method") == "landmarks-surface")
    lab.logic.startStep()
    lab.logic.startTrial("task-1", "desktop", method="fiducials", procedure="biopsy")
    lab.room.run_until(lambda: len(lab.room.sent("StartTask")) == 2)
    for start in lab.room.sent("StartTask"):
        assert (start["method"], start["procedure"], start["skin"]) == (
            "landmarks-surface",
            "dbs",
            skin,
        )
    for method, procedure, words in (
        ("landmarks-surface", "dbs", ""),
        ("landmarks-surface", "biopsy", "with the procedure biopsy"),
        ("fiducials", "dbs", "is doing task-1 by fiducials"),
    ):
        state = {"task": "task-1", "mode": "desktop", "method": method}
        lab.room.tell(**state, phase="running", procedure={"name": procedure})
        wanted = method, procedure
        lab.room.run_until(lambda wanted=wanted: wanted == lab.played)
        said = lab.logic.offProtocolSentence()
        assert words in said
        assert bool(words) is bool(said)
