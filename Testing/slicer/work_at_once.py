"""Background work that is done at once, for tests of its results."""

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
