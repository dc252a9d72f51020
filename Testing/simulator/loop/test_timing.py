"""The control loop's place among the threads of the machine."""

import os
import sys
import threading

import pytest

from rastrainer_simulator.loop.timing import (
    FIRST,
    SECOND,
    SWITCH_INTERVAL_S,
    precise_timing,
    raise_thread_priority,
)

linux_only = pytest.mark.skipif(sys.platform != "linux", reason="how Linux schedules threads")


def policy() -> int:
    return os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK


def in_a_thread(call):
    results = []
    thread = threading.Thread(target=lambda: results.append(call()))
    thread.start()
    thread.join()
    return results[0]


def may_be_first() -> bool:
    """Return whether the system permits this process a real-time priority."""

    def ask() -> bool:
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(FIRST))
        except PermissionError:
            return False
        return True

    return in_a_thread(ask)


@linux_only
def test_threads_sharing_the_loops_interpreter_rank_between_it_and_ordinary_threads():
    def priority() -> tuple[int, int]:
        return policy(), os.sched_getparam(0).sched_priority

    def second() -> tuple[tuple[int, int], tuple[int, int]]:
        raise_thread_priority()
        return priority(), in_a_thread(priority)

    def first() -> tuple[int, int]:
        with precise_timing(is_first_in_line=True):
            return priority()

    ordinary = (os.SCHED_OTHER, 0)
    itself, started = in_a_thread(second)
    assert started == ordinary
    if may_be_first():
        assert itself == (os.SCHED_FIFO, SECOND)
        assert in_a_thread(first) == (os.SCHED_FIFO, FIRST)
        assert FIRST > SECOND
    else:
        assert itself == in_a_thread(first) == ordinary


def test_the_interpreters_switching_is_restored_when_the_loop_ends():
    interval = sys.getswitchinterval()

    with precise_timing(is_first_in_line=False):
        assert sys.getswitchinterval() == pytest.approx(SWITCH_INTERVAL_S)
    # It is kept in whole microseconds.
    assert sys.getswitchinterval() == pytest.approx(interval, abs=2e-6)
