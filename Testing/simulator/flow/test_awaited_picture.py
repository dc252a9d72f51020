"""A task waits for the picture of the view that its trainee looks at, but not for a broken one."""

from __future__ import annotations

import pytest

from rastrainer.protocol import Phase
from rastrainer_simulator.flow import operated_views

VIEW = 1
"""The view of the trainee's keyboard."""


@pytest.fixture
def waiting(trainee):
    """Return a trainee whose trial has begun while the scene of its task is being built."""
    trainee.presenter.on_picture(VIEW, "", 1.0)
    assert trainee.submit("StartTask", task="task-1", trainee="P07", mode="desktop").ok
    trainee.until_menu("preparing")
    return trainee


def test_a_trial_and_its_clock_wait_until_the_view_has_drawn_it(waiting):
    assert waiting.state.training.phase is Phase.PAUSED
    before = waiting.state.elapsed
    assert before < 1.0
    assert waiting.menu.paragraphs[1].startswith("The picture is being prepared: head, robot")
    waiting.presenter.on_picture(VIEW, "task-1", 0.4)
    waiting.step(200)
    assert waiting.menu.paragraphs[1] == "The picture is being prepared: 40 % is loaded."
    assert waiting.state.elapsed == before
    waiting.presenter.on_picture(VIEW, "task-1", 1.0)
    waiting.until_menu(None)
    assert waiting.state.training.phase is Phase.RUNNING
    waiting.step(100)
    assert waiting.state.training.phase is Phase.RUNNING


def test_a_picture_is_not_waited_for_without_progress_or_if_the_trainee_begins(
    waiting, monkeypatch
):
    waiting.step(50)
    waiting.choose("begin", None)
    waiting.step(100)
    assert waiting.state.training.phase is Phase.RUNNING
    assert waiting.submit("Abort").ok
    waiting.presenter.on_picture(VIEW, "", 1.0)
    assert waiting.submit("StartTask", task="task-1", trainee="P07", mode="desktop").ok
    waiting.until_menu("preparing")
    monkeypatch.setattr(operated_views, "LONGEST_WAIT_S", 0.0)
    waiting.until_menu(None)
    assert waiting.state.training.phase is Phase.RUNNING


def test_a_trial_whose_view_leaves_while_it_waits_stays_paused(waiting):
    waiting.presenter.on_frames(VIEW, 0, 0, 60.0)
    waiting.presenter.on_silence(VIEW)
    waiting.step(100)
    # A view that loads may be too busy to say anything.
    assert waiting.menu.name == "preparing"
    waiting.presenter.view_left(VIEW)
    waiting.until_menu("trial")
    waiting.step(100)
    assert waiting.state.training.phase is Phase.PAUSED
    assert "closed or lost" in waiting.presenter.screen.warnings[0].text


def test_the_tutorial_asks_for_nothing_before_its_picture_is_there(trainee):
    session = trainee.presenter._session
    session.trainee = "P07"
    trainee.presenter.on_picture(VIEW, "", 1.0)
    session.begin_tutorial()
    trainee.step(50)
    said = lambda: trainee.presenter.screen.instruction.text  # noqa: E731
    assert said().startswith("The picture is being prepared")
    assert session.tutorial._seconds == {}
    trainee.presenter.on_picture(VIEW, "trial-run", 1.0)
    trainee.until(lambda: "30 mm to the right" in said(), "the first step")
