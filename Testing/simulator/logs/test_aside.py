"""Logs that nobody reads."""

import logging
import threading

from rastrainer_simulator.logs.aside import MOST_WAITING, Aside


class Blocked(logging.Handler):
    """Takes nothing until it is let go."""

    def __init__(self):
        super().__init__()
        self.go = threading.Event()
        self.taken = []

    def emit(self, record):
        self.go.wait()
        self.taken.append(record.getMessage())


def record(text):
    return logging.LogRecord("rastrainer", logging.WARNING, __file__, 1, text, None, None)


def test_a_log_that_nobody_reads_holds_nobody_up_and_keeps_what_came_first():
    blocked = Blocked()
    aside = Aside(blocked)
    for number in range(3 * MOST_WAITING):
        aside.handle(record(str(number)))
    blocked.go.set()
    aside.close()
    assert blocked.taken[:MOST_WAITING] == [str(number) for number in range(MOST_WAITING)]
    assert len(blocked.taken) <= MOST_WAITING + 1


def test_what_is_logged_last_is_written_when_the_log_ends():
    blocked = Blocked()
    blocked.go.set()
    aside = Aside(blocked)
    aside.handle(record("the end"))
    aside.close()
    assert blocked.taken == ["the end"]
