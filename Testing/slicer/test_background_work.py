"""Work in the background: in order, handed over on the main thread, and never blocking it."""

import gc
import sys
import threading

import pytest

from rastrainer.errors import InputError
from rastrainer.slicer import background_work
from rastrainer.slicer.background_work import TIME_S, BackgroundWork, Job, inBackground
from Testing.slicer.host.event_loop import process_events_keeping_lock, wait_keeping_lock

MAIN = threading.get_ident()
USUAL_SWITCH_INTERVAL_S = 0.005


@pytest.fixture
def work():
    work = BackgroundWork()
    yield work
    work.close()


def run(work):
    while work.isBusy:
        work.yieldTime()
        work.process()


def test_results_arrive_on_the_main_thread_in_the_order_of_the_jobs(work):
    seen, begun = [], []
    work.began.connect(lambda: begun.append(True))
    for number in range(3):
        work.do(
            lambda number=number: (number, threading.get_ident()),
            lambda result: seen.append((*result, threading.get_ident())),
        )
    assert seen == []
    run(work)
    assert [number for number, _there, _here in seen] == [0, 1, 2]
    assert all(there != MAIN and here == MAIN for _number, there, here in seen)
    assert begun == [True]


def test_an_error_in_a_job_is_reported_and_the_next_job_runs(work):
    received = []

    def refuse():
        raise InputError("The disk is full.")

    work.do(refuse, received.append, lambda error: received.append(str(error)))
    work.do(lambda: "done", received.append)
    run(work)
    assert received == ["The disk is full.", "done"]


def test_a_programming_error_is_raised_and_the_next_job_runs(work):
    received = []
    work.do(lambda: 1 // 0, received.append, lambda error: received.append(type(error)))
    work.do(lambda: "done", received.append)
    with pytest.raises(ZeroDivisionError):
        run(work)
    run(work)
    assert received == [ZeroDivisionError, "done"]


def test_a_result_handler_may_queue_more_work(work):
    received = []
    work.do(lambda: "first", lambda _result: work.do(lambda: "third", received.append))
    work.do(lambda: "second", received.append)
    run(work)
    assert received == ["second", "third"]


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


def test_the_main_thread_waits_only_briefly_for_a_worker(work, monkeypatch):
    waited, may_end, received = [], threading.Event(), []
    work.do(may_end.wait, received.append)
    thread = work._underWay[0].thread
    join = thread.join
    monkeypatch.setattr(thread, "join", lambda time: (waited.append(time), join(time)))
    for _ in range(3):
        work.yieldTime()
    may_end.set()
    assert waited == [TIME_S] * 3
    assert TIME_S <= 0.05
    while work.isBusy:
        work.yieldTime()
        work.process()
    assert received == [True]


@pytest.mark.usefixtures("host")
def test_jobs_proceed_although_slicer_holds_the_gil_while_waiting_for_events():
    has_turned = threading.Event()

    def count():
        return sum(number % 7 for number in range(2_000_000))

    def turn(_step, _share):
        process_events_keeping_lock()
        wait_keeping_lock()
        has_turned.set()

    assert inBackground(lambda _tell: (has_turned.wait(60), count()), turn) == (True, count())


def test_no_garbage_is_collected_in_a_worker_thread(work):
    was_enabled, seen = gc.isenabled(), []
    gc.enable()
    may_end = [threading.Event(), threading.Event()]
    jobs = [Job(lambda each=each: (seen.append(gc.isenabled()), each.wait())) for each in may_end]
    while len(seen) < 2:
        work.yieldTime()
    for job, each in zip(jobs, may_end, strict=True):
        assert not gc.isenabled()
        each.set()
        while not job.isDone:
            job.thread.join(TIME_S)
    assert seen == [False, False]
    assert gc.isenabled()
    if not was_enabled:
        gc.disable()


def test_a_job_canceled_by_its_user_is_aborted():
    ended = threading.Event()

    def work(tell):
        try:
            while True:
                tell("Counting", 0.5)
        finally:
            ended.set()

    def cancel(step, _share):
        if step:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        inBackground(work, cancel)
    assert ended.wait(120.0)


@pytest.fixture
def _usual_switches():
    """Threads take turns as often as Python has them."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(USUAL_SWITCH_INTERVAL_S)
    yield
    sys.setswitchinterval(before)


@pytest.mark.usefixtures("_usual_switches")
def test_a_worker_soon_releases_the_gil_and_everything_is_restored_afterward():
    may_end = threading.Event()
    job = Job(may_end.wait)
    assert sys.getswitchinterval() < USUAL_SWITCH_INTERVAL_S / 10
    may_end.set()
    while not job.isDone:
        job.thread.join(TIME_S)
    assert sys.getswitchinterval() == USUAL_SWITCH_INTERVAL_S


def test_jobs_start_only_after_deferred_calls():
    seen = []
    work = BackgroundWork()
    work.later(lambda: seen.append("later"))
    work.do(lambda: seen.append("work"), lambda _none: seen.append("taken"))
    assert work._underWay is None
    while work.isBusy:
        work.process()
        work.yieldTime()
    assert seen == ["later", "work", "taken"]


def test_queued_jobs_keep_the_worker_busy_while_a_result_is_delivered():
    busy = []
    work = BackgroundWork()
    work.do(lambda: None, lambda _none: busy.append(work.isBusy))
    work.do(lambda: None, lambda _none: busy.append(work.isBusy))
    while work.isBusy:
        work.yieldTime()
        work.process()
    assert busy == [True, False]
