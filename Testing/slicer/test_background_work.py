"""Work in the background: in order, handed over on the main thread, and never blocking it."""

import gc
import sys
import threading

import pytest

from rastrainer.errors import InputError
from rastrainer.slicer import background_work
from rastrainer.slicer.background_work import TIME_S, Job
from Testing.slicer.work_at_once import in_turns

MAIN = threading.get_ident()
USUAL_SWITCH_INTERVAL_S = 0.005


def test_results_arrive_on_the_main_thread_in_the_order_of_the_jobs(work):
    seen, begun = [], []
    work.began.connect(lambda: begun.append(work.isBusy))
    for number in range(3):
        work.do(
            lambda number=number: (number, threading.get_ident()),
            lambda result: seen.append((*result, threading.get_ident())),
        )
    assert seen == []
    in_turns(work)
    assert [number for number, _there, _here in seen] == [0, 1, 2]
    assert all(there != MAIN and here == MAIN for _number, there, here in seen)
    assert begun == [True] * 3


def test_an_error_is_reported_a_mistake_also_raised_and_the_next_job_runs(work):
    received = []

    def refuse():
        raise InputError("The disk is full.")

    work.do(refuse, received.append, lambda error: received.append(str(error)))
    work.do(lambda: 1 // 0, received.append, lambda error: received.append(type(error)))
    work.do(lambda: "done", received.append)
    with pytest.raises(ZeroDivisionError):
        in_turns(work)
    in_turns(work)
    assert received == ["The disk is full.", ZeroDivisionError, "done"]


def test_closing_delivers_results_that_come_soon_and_starts_no_further_job(work, monkeypatch):
    # Soon is a second, in which a busy machine may do nothing.
    monkeypatch.setattr(background_work, "CLOSING_S", 120.0)
    may_end, received = threading.Event(), []

    def take(result):
        received.append(result)
        work.do(lambda: received.append("begun"), received.append)

    work.do(lambda: may_end.wait(60), take)
    work.do(lambda: received.append("begun"), received.append)
    may_end.set()
    work.close()
    work.do(lambda: received.append("begun"), received.append)
    assert received == [True]
    assert not work.isBusy


def test_closing_does_not_wait_forever(work):
    may_end, received = threading.Event(), []
    work.do(may_end.wait, received.append)
    work.close()
    may_end.set()
    work.process()
    assert received == []


def test_while_jobs_run_no_garbage_is_collected_and_the_gil_is_released_soon(work):
    was_enabled, interval_s, seen = gc.isenabled(), sys.getswitchinterval(), []
    gc.enable()
    sys.setswitchinterval(USUAL_SWITCH_INTERVAL_S)
    may_end = [threading.Event(), threading.Event()]
    jobs = [Job(lambda each=each: (seen.append(gc.isenabled()), each.wait())) for each in may_end]
    while len(seen) < 2:
        work.yieldTime()
    for job, each in zip(jobs, may_end, strict=True):
        assert not gc.isenabled()
        assert sys.getswitchinterval() < USUAL_SWITCH_INTERVAL_S / 10
        each.set()
        while not job.isDone:
            job.thread.join(TIME_S)
    assert seen == [False, False]
    assert gc.isenabled()
    assert sys.getswitchinterval() == USUAL_SWITCH_INTERVAL_S
    sys.setswitchinterval(interval_s)
    if not was_enabled:
        gc.disable()
