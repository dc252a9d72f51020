"""Slicer sends the simulator each trainee's standing in the curriculum, when it is new."""

import uuid
from pathlib import Path

import pytest

from rastrainer.sections.trainees_logic import CurriculumLogic, TraineeLogic
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.database.study import Study
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.slicer.training_room import Room

SHIPPED = Path(__file__).parents[2] / "assets" / "studies" / "example-curriculum.json"


class Class:
    """A study with two trainees, and their teacher."""

    def __init__(self, room, folder):
        self.room = room
        self.trainees = TraineeLogic(lambda: Study.open(folder / "study.db"), folder / "journals")
        self.logic = CurriculumLogic(self.trainees, room.link)

    def play(self, trainee, count):
        """Have scored trials of the first task arrive."""
        for _ in range(count):
            record = make_record(trialId=str(uuid.uuid4()), trainee=trainee)
            self.trainees.study.add_trial(record, score=gentle_score(60.0, 0.2))
        self.trainees.changed.emit()

    @property
    def sent(self):
        """The messages sent to the simulator so far."""
        return self.room.all_sent("Curriculum")

    def close(self):
        self.logic.close()
        self.trainees.close()


@pytest.fixture
def lesson(scene, scenario, tmp_path):
    room = Room(scene, scenario)
    lesson = Class(room, tmp_path)
    for name in ("A", "B"):
        lesson.trainees.create(name, consent=True)
    yield lesson
    lesson.close()
    room.close()


def states(message):
    return [each["state"] for each in message["assignments"]]


def test_everybodys_progress_is_sent_first_and_then_only_what_is_new(lesson):
    lesson.logic.choose(Curriculum.read(SHIPPED), isForEverybody=True)
    sent = lesson.sent
    assert [each["trainee"] for each in sent] == ["A", "B"]
    assert states(sent[0]) == ["open"] + ["locked"] * 5
    assert (sent[0]["title"], sent[0]["next"]) == ("First steps", "first-points")
    lesson.trainees.choose("A")
    lesson.trainees.changed.emit()
    lesson.play("A", 2)
    sent = lesson.sent
    assert len(sent) == 3, "B has nothing new, and being chosen is nothing new"
    assert (sent[2]["trainee"], states(sent[2])) == (
        "A",
        ["reached", "open", "open", "open", "locked", "locked"],
    )
    assert sent[2]["next"] == "second-points"
    # A simulator that connects later is sent everything.
    lesson.room.link.opened.emit()
    assert sorted(each["trainee"] for each in lesson.sent[3:]) == ["A", "B"]


def test_an_archived_or_elsewhere_deleted_trainee_has_no_curriculum_any_more(lesson, tmp_path):
    lesson.logic.choose(Curriculum.read(SHIPPED), isForEverybody=True)
    assert list(lesson.logic.standings()) == ["A", "B"]
    lesson.trainees.choose("A")
    lesson.trainees.change(archived=True)
    last = lesson.sent[2]
    assert (last["trainee"], "assignments" in last) == ("A", False)
    lesson.trainees.change(archived=False)
    with Study.open(tmp_path / "study.db") as elsewhere:
        elsewhere.delete_trainee("A")
    lesson.room.link.opened.emit()
    assert list(lesson.logic.standings()) == ["B"]
