"""A trainee's curriculum at the seat: goals, gates, and the next assignment in the menu."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rastrainer.protocol import TRIAL_RUN, AssignmentState, GoalKind
from rastrainer.study_messages import AssignmentStanding, CurriculumMessage
from rastrainer_simulator.flow.pages.result import waiting_page
from rastrainer_simulator.flow.session.session import REACHED_S
from rastrainer_simulator.presentation.screen import Tone
from Testing.simulator.flow.trainee import STEP_S

LOCKED, OPEN, REACHED = AssignmentState
SCORE, COMPETENT = GoalKind


def standing(name, task, state=OPEN, needed=1, goal=SCORE, **others):
    return AssignmentStanding(name, task, goal=goal, state=state, needed=needed, **others)


TOLD = CurriculumMessage(
    "P07",
    "First steps",
    "two",
    (
        standing("one", "task-1", REACHED, 2, done=2, mark=70.0, played=3),
        standing("two", "task-2", OPEN, 3, done=1, mark=72.5, played=2, weakest="time"),
        standing("three", "task-3", LOCKED, 100, COMPETENT, mark=70.0, missing=("two",)),
        standing("four", "task-4", mode="hmd", mark=70.0),
        standing("five", "task-9", procedure="none", mark=70.0),
        standing("six", "task-4", scenario="elsewhere", mark=70.0),
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


def test_menu_and_board_show_the_progress_only_while_slicer_is_connected(menu, outside):
    row = menu.item("assignments")
    assert (row.label, row.value) == ("Your assignments", "1 of 6 reached")
    assert row.help == "Next: Task 2, your weakest. Most points are lost on time."
    text = "1 of 6 reached · Next: Task 2 (1 / 3)"
    assert menu.presenter.seat().assignments == text
    assert menu.item("task-2").is_enabled
    assert menu.item("task-3").help == "Locked. First reach: Task 2."
    assert menu.item("task-5").help == "Task 1 comes first."
    outside.has_slicer = False
    menu.step(20)
    assert menu.presenter.seat().assignments == ""
    assert "assignments" not in [item.name for item in menu.menu.items]
    assert menu.item("task-3").help == "Task 1 comes first."


def test_each_assignment_is_a_row_with_its_state_until_the_curriculum_ends(menu, outside):
    menu.choose("assignments", "assignments")
    assert menu.menu.focus == "assignment two"
    rows = [(item.label, item.value, item.is_enabled) for item in menu.menu.items]
    assert rows == [
        ("Task 1", "reached", True),
        ("Task 2", "1 / 3", True),
        ("Task 3", "locked", False),
        ("Task 4 · Headset", "0 / 1", True),
        ("task-9 · none", "0 / 1", False),
        ("Task 4", "0 / 1", False),
        ("Back", "", True),
    ]
    outside.services.assigned.take_curriculum(CurriculumMessage("P07"))
    menu.until_menu("experiment")


def test_an_assignment_begins_its_trial_in_its_mode_and_the_next_one_follows(menu, outside):
    menu.choose("assignments", "assignments")
    menu.choose("assignment four", None)
    assert (menu.state.training.task, menu.state.training.mode) == ("task-4", "hmd")
    finished = waiting_page(menu.presenter._session)
    for name, label in (("one", "Next: Task 1"), ("four", "Next: Task 4 · Headset"), ("", None)):
        outside.services.assigned.take_curriculum(replace(TOLD, next=name))
        offered = {row.item.name: row.item.label for row in finished.content().rows}
        assert offered.get("next") == label


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
