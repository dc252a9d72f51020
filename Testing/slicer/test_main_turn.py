"""Workers pause during the main thread's turn."""

import threading

import pytest

from rastrainer.slicer import main_turn
from rastrainer.slicer.background_work import Job, inBackground
from rastrainer.slicer.main_turn import giveWay, mainTurn, workersTurn

LONG_S = 60.0


class Worker:
    """A thread that gives way once and then is done."""

    def __init__(self):
        self._asked, self._done = threading.Event(), threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        assert self._asked.wait(LONG_S)

    def _run(self):
        self._asked.set()
        giveWay()
        self._done.set()

    def is_done_within(self, seconds):
        return self._done.wait(seconds)


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    monkeypatch.setattr(main_turn, "LONGEST_S", LONG_S)


def test_a_worker_runs_outside_of_the_main_threads_turns():
    assert Worker().is_done_within(LONG_S)


def test_a_worker_pauses_until_the_outermost_turn_is_over():
    with mainTurn():
        with mainTurn():
            worker = Worker()
        assert not worker.is_done_within(0.05)
    assert worker.is_done_within(LONG_S)


def test_a_turn_that_fails_is_over():
    with pytest.raises(ZeroDivisionError), mainTurn():
        raise ZeroDivisionError
    assert Worker().is_done_within(LONG_S)


def test_a_worker_may_run_during_a_turn_which_then_continues():
    with mainTurn():
        worker = Worker()
        with workersTurn():
            assert worker.is_done_within(LONG_S)
        assert not Worker().is_done_within(0.05)


def test_a_turn_that_does_not_end_does_not_hold_a_worker_for_ever(monkeypatch):
    monkeypatch.setattr(main_turn, "LONGEST_S", 0.01)
    with mainTurn():
        assert Worker().is_done_within(LONG_S)


def test_who_gives_a_job_time_in_its_own_turn_lets_it_run():
    def work():
        giveWay()
        return "done"

    with mainTurn():
        job = Job(work)
        job.giveTime(LONG_S)
        assert job.isDone
        assert job.result() == "done"


def test_who_waits_for_work_in_its_own_turn_gets_what_it_returns():
    def work(_tell):
        giveWay()
        return "done"

    with mainTurn():
        assert inBackground(work, lambda _step, _share: None) == "done"
