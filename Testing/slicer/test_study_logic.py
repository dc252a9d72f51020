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
        return status.trainee, status.method, status.procedure.name

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
    lab.begin()
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


def test_the_study_starts_only_what_comes_next(enrolled):
    logic, room = enrolled.logic, enrolled.room
    enrolled.trainees.create("T002", consent=True)
    with pytest.raises(InputError, match="Enroll the trainee"):
        logic.startTrial("task-1", "hmd")
    enrolled.trainees.choose("T001")
    with pytest.raises(InputError, match="Answer the questionnaire SSQ"):
        logic.startStep()
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


def test_only_the_trainees_own_practice_counts_since_its_start_or_since_slicer_connected(
    practicing,
):
    practicing.tell(phase="running", elapsedS=250.0)
    practicing.tell(phase="running", elapsedS=280.0)
    assert practicing.logic.minutesElapsed(practicing.logic.progress()) == 0.5
    practicing.tell(phase="running", elapsedS=30.0, trialId="another")
    practicing.tell(phase="running", elapsedS=40.0, trialId="another")
    practicing.tell(phase="idle", elapsedS=0.0)
    assert practicing.logic.progress().practiced_s == pytest.approx(30.0 + 40.0)
    for other in ({"trainee": "T002"}, {"task": "task-1"}, {"mode": "desktop"}):
        practicing.practice(600.0, **other)
    assert practicing.logic.progress().practiced_s == pytest.approx(30.0 + 40.0)
    # It ends by itself while it is played.
    practicing.tell(phase="running", elapsedS=0.0)
    practicing.tell(phase="running", elapsedS=229.9)
    assert practicing.next == "hmd/trial-run"
    practicing.tell(phase="running", elapsedS=230.1)
    assert practicing.next == "hmd/1/task-1"
    assert practicing.logic.progress().entries[-1].details["minutes"] == pytest.approx(5.0, 1e-3)


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
    lab.logic.process()
    assert lab.next == "desktop/break"
    lab.moment += timedelta(minutes=0.2)
    lab.logic.process()
    entry = lab.logic.progress().entries[-1]
    assert (entry.outcome, round(entry.details["minutes"], 1)) == ("done", 10.1)
    assert lab.next == "desktop/1/task-1"


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


def sent_step(lab):
    """The last step that was sent to the simulator; empty before."""
    steps = lab.room.sent("StudyStep")
    return steps[-1] if steps else {}


def test_the_simulator_is_sent_each_next_step_once_and_all_steps_when_it_connects(enrolled):
    room = enrolled.room
    room.run_until(lambda: sent_step(enrolled).get("questionnaire") == "ssq")
    enrolled.logic.answer([0] * 16)
    room.run_until(lambda: sent_step(enrolled)["kind"] == "trial-run")
    run = {"kind": "trial-run", "task": "trial-run", "mode": "hmd", "minutes": 5.0}
    assert sent_step(enrolled) == {"trainee": "T001", "number": 2, "count": 19, **run}
    count = len(room.sent("StudyStep"))
    enrolled.trainees.changed.emit()
    enrolled.skip("has practiced in the pilot")
    room.run_until(lambda: sent_step(enrolled)["kind"] == "trial")
    assert len(room.sent("StudyStep")) == count + 1
    # A simulator that connects later is sent the steps of all.
    enrolled.trainees.create("T002", consent=True)
    enrolled.logic.enroll()
    room.run_until(lambda: sent_step(enrolled).get("trainee") == "T002")
    assert sorted(step["trainee"] for step in enrolled.reconnect(2)) == ["T001", "T002"]
    enrolled.trainees.delete()
    room.run_until(lambda: sent_step(enrolled) == {"trainee": "T002", "kind": "free"})


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
    for count in (3, 4):
        answered(enrolled, answers=[3] * 16)
        # The first step, and the next one after each answer.
        enrolled.room.run_until(lambda count=count: len(enrolled.room.sent("StudyStep")) == count)
    (kept,) = StudyProgress(enrolled.trainees.study).answers()
    assert (kept.trainee, kept.step.name, kept.answers) == ("T001", "hmd/before/ssq", (1,) * 16)
    assert sent_step(enrolled)["kind"] == "trial-run"


def test_answers_that_do_not_belong_to_the_step_are_not_stored(enrolled):
    for wrong in (
        {"answers": [4] * 16},
        {"answers": 7},
        {"trainee": ["T001"]},
        {"number": 2},
        {"questionnaire": "sus", "answers": [1] * 10},
    ):
        answered(enrolled, **wrong)
        enrolled.tell(phase="running")
        enrolled.tell(phase="idle")
        assert enrolled.next == "hmd/before/ssq", wrong


def test_the_simulator_waits_until_an_aborted_trial_has_its_reason(enrolled):
    while enrolled.logic.progress().next_step.kind is not StepKind.TRIAL:
        enrolled.skip("this is not what is tested")
    step = enrolled.logic.progress().next_step
    played = {"trainee": "T001", "mode": step.mode, "task": step.task}
    started = datetime.now(timezone.utc).isoformat()
    enrolled.trainees.study.add_aborted(make_aborted(**played, startedUtc=started))
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
    for trainee, method, procedure, words in (
        ("T001", "landmarks-surface", "dbs", ""),
        ("T001", "landmarks-surface", "biopsy", "with the procedure biopsy"),
        ("T001", "fiducials", "dbs", "is doing task-1 by fiducials"),
        ("somebody", "fiducials", "dbs", ""),
    ):
        state = {"trainee": trainee, "task": "task-1", "mode": "desktop", "method": method}
        lab.room.tell(**state, phase="running", procedure={"name": procedure})
        wanted = trainee, method, procedure
        lab.room.run_until(lambda wanted=wanted: wanted == lab.played)
        said = lab.logic.offProtocolSentence()
        assert words in said
        assert bool(words) is bool(said)
