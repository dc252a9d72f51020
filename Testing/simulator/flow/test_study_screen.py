"""A study that Slicer leads: the trainee's own menu begins the next step, and nothing else."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rastrainer.protocol import FREE, RegistrationMethod
from rastrainer.study.protocol.steps import StepAnswers
from rastrainer.study_messages import StudyStep
from rastrainer_simulator.flow.session.assigned_training import (
    ANSWERED,
)
from rastrainer_simulator.flow.session.chosen_trial import registration_method, start_task

TASK_2 = StudyStep("P07", "trial", 3, 19, "task-2", "desktop")


@pytest.fixture
def guide(outside):
    """What Slicer sends about the study, while no time of a break passes."""
    outside.services.assigned._clock = lambda: 100.0
    return outside.services.assigned


@pytest.fixture
def menu(trainee):
    """The trainee at the experiment menu, with the ID P07."""
    trainee.open_experiment()
    trainee.presenter.on_text(1, "trainee", "P07")
    trainee.step()
    return trainee


def enabled(menu):
    names = ("trial-run", *(f"task-{number}" for number in range(1, 6)))
    return [name for name in names if menu.item(name).is_enabled]


def tell(menu, guide, step):
    """Process a message from Slicer, and wait until the menu can show it."""
    guide.take_step(step)
    menu.step(20)


def test_only_what_comes_next_can_be_started_and_the_menu_says_what_that_is(menu, guide):
    assert (enabled(menu), menu.menu.paragraphs) == (["trial-run"], ())
    tell(menu, guide, TASK_2)
    assert enabled(menu) == ["task-2"]
    assert menu.menu.paragraphs == ("Step 3 of 19: play Task 2 on the desktop screen.",)
    assert menu.item("task-1").help == (
        "Not now. Step 3 of 19: play Task 2 on the desktop screen. Only your instructor can skip "
        "a step, in 3D Slicer and with a reason."
    )
    menu.focus("task-3")
    menu.tap("accept")
    menu.step()
    assert (menu.watcher.kinds[-1], menu.state.training.phase) == ("error", "idle")
    menu.choose("task-2", None)
    assert (menu.state.training.task, menu.state.training.mode) == ("task-2", "desktop")


def test_nothing_can_be_started_in_another_mode_or_at_another_step(menu, guide):
    tell(menu, guide, StudyStep("P07", "break", 4, 9, minutes=10.0, over=9.9))
    assert enabled(menu) == []
    assert "take a break of at least 10 minutes, 00:0" in menu.menu.paragraphs[0]
    tell(menu, guide, TASK_2)
    menu.focus("mode")
    menu.tap("right")
    menu.step(20)
    assert enabled(menu) == []
    assert "on the desktop screen" in menu.item("task-2").help


def test_trainees_who_are_not_or_no_longer_in_the_study_practice_freely(menu, guide):
    tell(menu, guide, StudyStep("P08", "all-done", 9, 9))
    assert enabled(menu) == ["trial-run"]
    tell(menu, guide, TASK_2)
    tell(menu, guide, StudyStep("P07", FREE))
    assert enabled(menu) == ["trial-run"]


def test_the_trial_run_ends_with_the_studys_minutes_even_if_slicer_has_moved_on(menu, guide):
    step = StudyStep("P07", "trial-run", 2, 9, "trial-run", "desktop", minutes=8.0, over=7.9)
    tell(menu, guide, step)
    menu.choose("trial-run", None)
    assert menu.presenter.screen.status[2].startswith("00:0")
    guide.take_step(TASK_2)
    menu.until_menu("practice")
    assert "end the trial run to continue the study" in menu.menu.paragraphs[0]
    menu.choose("finish", "experiment")
    assert enabled(menu) == ["task-2"]


def mark(menu, number, *directions):
    menu.focus(f"sus_{number}")
    menu.tap(*directions)
    menu.step(20)


def test_a_questionnaire_is_answered_line_by_line_and_submitted_only_when_complete(menu, guide):
    step = StudyStep("P07", "questionnaire", 5, 19, mode="desktop", questionnaire="sus")
    tell(menu, guide, step)
    assert enabled(menu) == []
    menu.choose("answer", "questionnaire")
    guide.take_step(TASK_2)
    menu.until_menu("experiment")
    tell(menu, guide, step)
    menu.choose("answer", "questionnaire")
    for number in range(1, 10):
        mark(menu, number, "right", "right")
    assert not menu.item("keep").is_enabled
    mark(menu, 10, "left", "left", "left")
    menu.choose("keep", "experiment")
    (answers,) = tuple(guide.answers.values())
    assert answers == StepAnswers("P07", 5, "sus", (2,) * 9 + (3,))
    # They wait until Slicer moves on, and are then forgotten.
    guide.take_step(step)
    assert (len(guide.answers), guide.steps.get("P07").kind) == (1, ANSWERED)
    guide.take_step(TASK_2)
    assert (len(guide.answers), guide.steps.get("P07")) == (0, TASK_2)


def test_a_requested_trial_is_not_started_twice_before_slicer_sends_the_next_step(menu, guide):
    tell(menu, guide, TASK_2)
    guide.note_registered("P07", "task-1", "desktop")
    menu.step(20)
    assert enabled(menu) == ["task-2"]
    guide.note_registered("P07", "task-2", "desktop")
    menu.step(20)
    assert enabled(menu) == []
    assert menu.menu.paragraphs == ("Task 2 is done. 3D Slicer will announce the next step.",)


def test_a_study_trial_is_registered_by_the_method_of_its_protocol(menu, guide):
    session = menu.presenter._session
    chosen = registration_method(session, "task-2")
    tell(menu, guide, replace(TASK_2, method="surface"))
    assert menu.menu.paragraphs == (
        "Step 3 of 19: play Task 2 by a trace over the skin on the desktop screen.",
    )
    assert registration_method(session, "task-2") is RegistrationMethod.SURFACE
    method = menu.item("method")
    assert (method.value, method.is_enabled) == ("trace over the skin", False)
    tell(menu, guide, TASK_2)
    assert registration_method(session, "task-2") is RegistrationMethod.FIDUCIALS
    tell(menu, guide, StudyStep("P07", FREE))
    assert registration_method(session, "task-2") is chosen


def test_a_study_trial_has_the_skin_of_its_protocol(menu, guide):
    session = menu.presenter._session
    skin = {"shiftMm": 2.0, "indentationMm": 0.5}
    tell(menu, guide, TASK_2)
    known = menu.menu
    tell(menu, guide, replace(TASK_2, skin=skin))
    assert menu.menu == known
    start_task(session, "task-2")
    menu.until_menu(None)
    truth = session.control_loop.simulation.truth
    assert (truth.skin.shift_mm, truth.skin.indentation_mm) == (2.0, 0.5)
    assert truth.skin.seed > 0
