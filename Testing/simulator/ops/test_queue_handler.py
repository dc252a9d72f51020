"""Logs that nobody reads."""

import logging
import threading
import time

from rastrainer_simulator.ops.log_files import MOST_WAITING, BackgroundHandler


class Blocked(logging.Handler):
    """Takes nothing until it is let go."""

    def __init__(self):
        super().__init__()
        self.reached = threading.Event()
        self.go = threading.Event()
        self.taken = []

    def emit(self, record):
        self.reached.set()
        self.go.wait()
        self.taken.append(record.getMessage())


def record(text):
    return logging.LogRecord("rastrainer", logging.WARNING, __file__, 1, text, None, None)


def test_a_log_that_nobody_reads_holds_nobody_up_keeps_what_came_first_and_counts_the_rest():
    blocked = Blocked()
    aside = BackgroundHandler(blocked)
    aside.handle(record("0"))
    blocked.reached.wait()
    for number in range(1, 3 * MOST_WAITING):
        aside.handle(record(str(number)))
    blocked.go.set()
    aside.close()
    *kept, gap = blocked.taken
    assert kept == [str(number) for number in range(len(kept))]
    assert len(kept) == MOST_WAITING + 1
    assert gap == f"{2 * MOST_WAITING - 1} lines are missing here: nobody took them in time."


def test_lost_lines_are_told_where_they_would_have_stood():
    blocked = Blocked()
    aside = BackgroundHandler(blocked)
    aside.handle(record("kept or lost"))
    blocked.reached.wait()
    for _ in range(2 * MOST_WAITING):
        aside.handle(record("kept or lost"))
    blocked.go.set()
    while len(blocked.taken) < MOST_WAITING + 1:
        time.sleep(0.001)
    aside.handle(record("later"))
    aside.close()
    assert "lines are missing here" in blocked.taken[-2]
    assert blocked.taken[-1] == "later"
    assert set(blocked.taken[:-2]) == {"kept or lost"}


def test_what_is_logged_last_is_written_when_the_log_ends():
    blocked = Blocked()
    blocked.go.set()
    aside = BackgroundHandler(blocked)
    aside.handle(record("the end"))
    aside.close()
    assert blocked.taken == ["the end"]
