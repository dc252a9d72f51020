"""Background work, done at once or turn by turn until nothing is left, for tests of its results."""

from __future__ import annotations

from rastrainer.errors import InputError


class WorkAtOnce:
    """Stands in for `BackgroundWork`."""

    def do(self, work, take, refuse=lambda _error: None):
        try:
            result = work()
        except InputError as error:
            refuse(error)
        else:
            take(result)

    def later(self, function):
        function()


def in_turns(work, then=lambda: None):
    """Let all work be done; `then` is called after each turn."""
    while work.isBusy:
        work.yieldTime()
        work.process()
        then()
