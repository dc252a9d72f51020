"""Training without an instructor: an ID, skipped steps, and the own trials."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from rastrainer.protocol import TRIAL_RUN
from rastrainer_simulator.flow.session.chosen_trial import FIRST_ID
from rastrainer_simulator.input.inputs import ControlName
from Testing.simulator.flow.scored_journals import TRAINEE, write_scored
from Testing.simulator.flow.trainee import Keys, Trainee


@pytest.fixture
def alone(loop, outside):
    """Return what begins a trainee at the task menu, with the usual preferences."""
    open_ = []

    def begin(**preferences) -> Trainee:
        presenter = outside.presenter(loop, **preferences)
        trainee = Trainee(loop, presenter, Keys)
        open_.append((trainee, presenter))
        trainee.until_menu("start")
        trainee.open_experiment()
        return trainee

    yield begin
    for trainee, presenter in open_:
        trainee.close()
        presenter.close()


@pytest.mark.parametrize("with_pin", [False, True], ids=["Slicer", "PIN"])
def test_an_instructor_gives_the_id_and_requires_what_comes_first(alone, outside, with_pin):
    if with_pin:
        outside.pin.set("123456")
    outside.has_slicer = not with_pin
    trainee = alone()
    assert trainee.item("trainee").value == ""
    assert "skip" not in [item.name for item in trainee.menu.items]
    trainee.focus("trainee")
    trainee.hands.type("P07")
    offers = "skip" in [item.name for item in trainee.menu.items]
    assert offers is not with_pin


def test_an_id_is_there_and_tutorial_and_trial_run_are_skipped_one_after_the_other(alone):
    trainee = alone()
    assert trainee.item("trainee").value == FIRST_ID
    for label, following in (
        ("Skip the tutorial", TRIAL_RUN),
        ("Skip the trial run", "task-1"),
    ):
        assert trainee.item("skip").label == label
        trainee.choose("skip")
        trainee.step(2)
        assert trainee.menu.focus == following
    assert trainee.item("task-1").is_enabled
    assert "skip" not in [item.name for item in trainee.menu.items]


def test_own_trials_are_listed_and_a_failed_task_is_not_done(alone, outside):
    records = outside.services.records
    write_scored(records, 1, 40.0)
    write_scored(records, 2, 90.0, task="task-2")
    write_scored(records, 3, 90.0, task="task-3", is_safe=False)
    trainee = alone(order="any", tutorial="skipped")
    assert trainee.item("trainee").value == TRAINEE
    values = {name: trainee.item(name).value for name in ("task-1", "task-2", "task-3", "task-4")}
    assert values == {
        "task-1": "not passed",
        "task-2": "passed",
        "task-3": "not passed",
        "task-4": "",
    }
    assert trainee.item("trials").value == "3"
    trainee.choose("trials", "own-trials")
    listed = [item.value for item in trainee.menu.items[:3]]
    assert listed == ["90 / 100, not passed", "90 / 100, passed", "40 / 100, not passed"]
    trainee.tap("accept")
    trainee.until(lambda: trainee.menu is None or trainee.menu.name != "replay", "the journal")
    trainee.step(15)
    # It is too short to be shown; the list stays.
    assert trainee.menu.name == "own-trials"
    assert trainee.presenter.screen.warnings


def test_a_poor_touch_of_the_trial_run_is_named_with_the_key_that_takes_it_back(trainee):
    trainee.start(TRIAL_RUN)
    session = trainee.presenter._session
    place, center = trainee.place("1"), trainee.place()
    screen = trainee.presenter._flow._trial_screen
    screen._points = {**screen._points, "1": tuple(np.add(place, (0.0, 0.005, 0.0)).tolist())}
    trainee.touch(place, center)
    trainee.steer_to(place + 0.2 * (place - center), 0.005)
    trainee.step(15)
    said = trainee.presenter.screen.instruction.text
    assert said.startswith("Point 1: ")
    assert f"Take it back with {session.operator.label(ControlName.UNDO)}" in said
    session.state = replace(session.state, training=replace(session.state.training, task="task-1"))
    assert not screen._instruction().text.startswith("Point 1: ")
