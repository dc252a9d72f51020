"""A trainee's curriculum at the seat: goals, gates, and the next assignment in the menu."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rastrainer.protocol import FREE, TRIAL_RUN, AssignmentState, GoalKind
from rastrainer.study_messages import AssignmentStanding, CurriculumMessage, StudyStep
from rastrainer_simulator.flow.pages.result import waiting_page
from rastrainer_simulator.flow.session.session import REACHED_S
from rastrainer_simulator.presentation.screen import Tone
from Testing.simulator.flow.trainee import STEP_S

LOCKED, OPEN, REACHED = AssignmentState
SCORE, COMPETENT = GoalKind


def toward(goal, state, needed):
    return {"goal": goal, "state": state, "needed": needed}


TOLD = CurriculumMessage(
    "P07",
    "First steps",
    "two",
    (
        AssignmentStanding(
            "one", "task-1", **toward(SCORE, REACHED, 2), done=2, mark=70.0, played=3
        ),
        AssignmentStanding(
            "two",
            "task-2",
            goal=SCORE,
            state=OPEN,
            needed=3,
            done=1,
            mark=72.5,
            played=2,
            weakest="time",
        ),
        AssignmentStanding(
            "three", "task-3", **toward(COMPETENT, LOCKED, 100), mark=70.0, missing=("two",)
        ),
        AssignmentStanding("four", "task-4", **toward(SCORE, OPEN, 1), mode="hmd", mark=70.0),
        AssignmentStanding("five", "task-9", **toward(SCORE, OPEN, 1), procedure="none", mark=70.0),
        AssignmentStanding(
            "six", "task-4", **toward(SCORE, OPEN, 1), scenario="elsewhere", mark=70.0
        ),
    ),
)


@pytest.fixture
def menu(trainee, outside):
    """The trainee at the experiment menu with the ID P07, the trial run done, and Slicer there."""
    outside.has_slicer = True
    session = trainee.presenter._session
    session.history.done["P07", session.scenario.name].add(TRIAL_RUN)
    outside.services.assigned.take_curriculum(TOLD)
    trainee.go_to_experiment("P07")
    trainee.step(20)
    return trainee


@pytest.fixture
def page(menu):
    menu.choose("assignments", "assignments")
    return menu


def test_the_menu_shows_the_trainees_progress_and_what_comes_next(menu):
    row = menu.item("assignments")
    assert (row.label, row.value) == ("Your assignments", "1 of 6 reached")
    assert row.help == "Next: Task 2, your weakest. Most points are lost on time."


def test_a_board_can_read_a_trainees_progress(menu, outside):
    text = "1 of 6 reached · Next: Task 2 (1 / 3)"
    assert menu.presenter.seat().assignments == text
    outside.has_slicer = False
    assert menu.presenter.seat().assignments == ""


def test_each_assignment_is_a_row_with_its_state_and_the_next_one_has_focus(page):
    assert page.menu.paragraphs[0] == "First steps"
    assert page.menu.focus == "assignment two"
    rows = [(item.label, item.value, item.is_enabled) for item in page.menu.items]
    assert rows == [
        ("Task 1", "reached", True),
        ("Task 2", "1 / 3", True),
        ("Task 3", "locked", False),
        ("Task 4 · Headset", "0 / 1", True),
        ("task-9 · none", "0 / 1", False),
        ("Task 4", "0 / 1", False),
        ("Back", "", True),
    ]
    assert page.item("assignment two").help == (
        "Task 2. Reached when 3 trials in a row have 72.5 points or more, within all limits."
    )
    assert page.item("assignment three").help == "Locked. First reach: Task 2."
    for elsewhere in ("five", "six"):
        assert "Not possible on this head" in page.item(f"assignment {elsewhere}").help


def test_an_assignment_begins_its_trial_in_its_mode(page):
    page.choose("assignment four", None)
    assert (page.state.training.task, page.state.training.mode) == ("task-4", "hmd")


def test_after_a_trial_the_next_assignment_is_offered_instead_of_the_next_task(page, outside):
    page.choose("assignment one", None)
    finished = waiting_page(page.presenter._session)
    offered = {row.item.name: row.item.label for row in finished.content().rows}
    assert offered["next"] == "Next: Task 2"
    outside.services.assigned.take_curriculum(replace(TOLD, next="four"))
    offered = {row.item.name: row.item.label for row in finished.content().rows}
    assert offered["next"] == "Next: Task 4 · Headset"
    finished.back()
    assert page.presenter._session.pages.top.content().first == "assignments"
    outside.services.assigned.take_curriculum(replace(TOLD, next=""))
    assert "next" not in [row.item.name for row in finished.content().rows]


def test_a_locked_task_waits_for_its_gate_and_an_open_one_for_no_earlier_task(menu):
    assert menu.item("task-2").is_enabled
    assert not menu.item("task-3").is_enabled
    assert menu.item("task-3").help == "Locked. First reach: Task 2."
    assert menu.item("task-5").help == "Task 1 comes first."


def test_a_study_takes_precedence_over_a_curriculum(menu, outside):
    outside.services.assigned.take_step(StudyStep("P07", "trial", 3, 19, "task-3", "desktop"))
    menu.step(20)
    assert "assignments" not in [item.name for item in menu.menu.items]
    assert menu.item("task-3").is_enabled
    outside.services.assigned.take_step(StudyStep("P07", FREE))
    menu.step(20)
    assert menu.item("assignments").is_enabled


def test_without_slicer_nothing_is_locked_and_nothing_is_announced(menu, outside):
    outside.has_slicer = False
    menu.step(20)
    assert "assignments" not in [item.name for item in menu.menu.items]
    assert menu.item("task-3").help == "Task 1 comes first."


def test_the_page_closes_when_the_curriculum_ends(page, outside):
    outside.services.assigned.take_curriculum(CurriculumMessage("P07"))
    page.until_menu("experiment")


def said(menu):
    return [(each.text, each.tone) for each in menu.presenter.screen.warnings]


def test_a_reached_assignment_is_announced_once_and_only_to_its_own_trainee(menu, outside):
    two = replace(TOLD.assignments[1], state=REACHED, done=3)
    reached = replace(TOLD, assignments=(TOLD.assignments[0], two, *TOLD.assignments[2:]))
    outside.services.assigned.take_curriculum(replace(reached, trainee="P08"))
    menu.presenter.on_text(1, "trainee", "P08")
    menu.step(20)
    menu.presenter.on_text(1, "trainee", "P07")
    menu.step(20)
    assert said(menu) == []
    outside.services.assigned.take_curriculum(reached)
    menu.step(20)
    assert said(menu) == [("Reached: Task 2.", Tone.GOOD)]
    menu.step(round((REACHED_S + 1.0) / STEP_S))
    assert said(menu) == []
    outside.services.assigned.take_curriculum(replace(reached, title="The same"))
    menu.step(20)
    assert said(menu) == []
