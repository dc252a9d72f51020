"""A trainee's session begins a drill, has an open one continued, and hands a finished one over."""

from __future__ import annotations

import time

import pytest

from rastrainer.decision.drill_record import CASES, Decision
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.controls import Controls, ControlsListener
from Testing.simulator.decision.drills import PATIENCE_S, AtOnce, cheap_forms


@pytest.fixture(autouse=True)
def _quick_drills(loop, monkeypatch):
    monkeypatch.setattr(loop, "_writer", AtOnce())
    with cheap_forms():
        yield


@pytest.fixture
def session(loop, outside):
    return start(loop, outside)


def start(loop, outside, trainee="P01", **preferences):
    """Return the session of a simulator that has just been started."""
    nothing = ControlsListener(*[lambda *_: False] * 4)
    controls = Controls(DEFAULT_BINDINGS, nothing, lambda: True)
    given = Preferences(**preferences)
    session = TrainingSession(loop, controls, outside.services, given, lambda _event: None)
    session.trainee = trainee
    return session


def wait(session, is_there):
    give_up = time.monotonic() + PATIENCE_S
    while not is_there():
        session.advance(0.0, session.control_loop.latest)
        time.sleep(0.001)
        assert time.monotonic() < give_up


def begin(session):
    session.begin_drill()
    drill = session.drill
    wait(session, lambda: drill.is_ready)
    return drill


def told(session):
    return [notice.text for notice in session.notices.shown(session.texts)]


def play(session, drill):
    while not drill.is_over:
        if drill.decided is not None:
            drill.next_case()
        wait(session, lambda: drill.is_ready)
        drill.decide(Decision.STOP, 60)
    wait(session, lambda: drill.is_finished)


def test_an_open_drill_has_to_be_continued_by_its_trainee_alone_until_it_is_over(
    session, loop, outside
):
    assert session.open_drill is None
    drill = begin(session)
    drill.decide(Decision.STOP, 60)
    session.leave_drill()
    assert session.drill is None
    assert session.open_drill is not None
    again = begin(session)
    assert (again.trial_id, again.decided) == (drill.trial_id, drill.decided)
    session.trainee = "P02"
    assert session.open_drill is None
    assert begin(session).trial_id != drill.trial_id
    session.leave_drill()
    restarted = start(loop, outside)
    assert restarted.open_drill is not None
    play(restarted, last := begin(restarted))
    assert restarted.open_drill is None
    (record,) = restarted.history.drills("P01")
    assert (record.trial_id, len(record.cases)) == (drill.trial_id, CASES)
    following = begin(restarted)
    assert following.trial_id != last.trial_id
    assert following.case.seed not in {case.seed for case in record.cases}
    wait(
        restarted,
        lambda: record.trial_id in {one.trial_id for one in loop.archive.unacknowledged()},
    )
    restarted.leave_drill()


def test_a_drill_of_another_version_is_abandoned_once_another_begins_and_the_trainee_is_told(
    session, loop, monkeypatch
):
    drill = begin(session)
    session.leave_drill()
    monkeypatch.setattr("rastrainer.__version__", "9.9.9")
    assert session.open_drill is None
    again = begin(session)
    assert again.trial_id != drill.trial_id
    assert "Your unfinished drill on" in "".join(told(session))
    (abandoned,) = loop.archive.unacknowledged()
    assert (abandoned.trial_id, abandoned.number) == (drill.trial_id, 1)
    assert again.header.number == 2
    session.leave_drill()
    assert begin(session).trial_id == again.trial_id
    session.leave_drill()
