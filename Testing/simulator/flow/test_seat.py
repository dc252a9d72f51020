"""A seat as a teacher's board reads it, and the orders that a teacher can give there."""

from __future__ import annotations

from rastrainer_simulator.flow.flow_presenter import SENTENCE_S
from rastrainer_simulator.presentation.messages import InstructorOrder
from rastrainer_simulator.presentation.screen import Tone
from Testing.simulator.flow.trainee import STEP_S


def said(trainee) -> list[str]:
    return [warning.text for warning in trainee.presenter.screen.warnings]


def test_a_board_reads_who_is_training_what_and_how_far_the_trial_is(trainee, presenter, outside):
    before = presenter.seat()
    assert (before.trainee, before.task, before.count, before.score) == ("", "", 0, None)
    assert before.screen == presenter.screen.menu.title
    outside.has_slicer = True
    trainee.start("task-2", trainee="P11")
    trainee.step(20)
    seat = presenter.seat()
    assert (seat.trainee, seat.task, seat.count) == ("P11", "Task 2", 15)
    assert (seat.screen, seat.slicer) == ("", True)
    assert seat.instruction == presenter.screen.instruction.text
    # A notice is none of the warnings.
    assert presenter.instruct(InstructorOrder.SAY, "Well done.") == ""
    trainee.until(lambda: said(trainee), "the message")
    assert presenter.seat().warnings == ()
    outside.has_slicer = False
    trainee.until(lambda: presenter.seat().warnings, "the warning of the lost Slicer")


def test_a_teachers_message_is_shown_and_disappears_after_its_time(trainee, presenter):
    assert presenter.instruct(InstructorOrder.SAY, "Look from the side <b>.") == ""
    trainee.until(lambda: said(trainee), "the message")
    (warning,) = presenter.screen.warnings
    assert warning.text == "Your instructor: Look from the side <b>."
    assert warning.tone is Tone.PLAIN
    trainee.step(round((SENTENCE_S + 0.5) / STEP_S))
    assert said(trainee) == []


def test_a_teacher_pauses_a_trial_and_the_trainee_sees_who_did(trainee, presenter):
    nothing = "Nothing that could be paused is running at this seat."
    assert presenter.instruct(InstructorOrder.PAUSE, "") == nothing
    trainee.start("task-1")
    assert presenter.instruct(InstructorOrder.PAUSE, "") == ""
    trainee.until_menu("trial")
    assert "Paused by your instructor." in said(trainee)
    assert presenter.instruct(InstructorOrder.PAUSE, "") == nothing
    trainee.choose("resume", None)
    assert "Paused by your instructor." not in said(trainee)
