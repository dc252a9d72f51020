"""Work of the main thread in small parts, one in a turn of its event loop."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from importlib import import_module, util

_OURS = re.compile(r"^from (rastrainer[\w.]*) import (\([^)]*\)|.*)", re.MULTILINE)


class Turns:
    """Runs the steps of an iterator, each in a later turn; it may be finished at once.

    Once `isOver` is set, no step follows.
    """

    def __init__(
        self, steps: Iterator[object], callSoon: Callable[[Callable[[], None]], None]
    ) -> None:
        self.isOver = self._isAtWork = False
        self._steps = steps
        self._callSoon = callSoon
        callSoon(self._go)

    def finish(self) -> None:
        """Do the remaining steps now, unless a step asks for that itself."""
        while not (self.isOver or self._isAtWork):
            self._step()

    def _go(self) -> None:
        if not (self.isOver or self._isAtWork):
            self._step()
            self._callSoon(self._go)

    def _step(self) -> None:
        self._isAtWork = True
        try:
            next(self._steps)
        except BaseException as error:
            self.isOver = True
            if not isinstance(error, StopIteration):
                raise
        finally:
            self._isAtWork = False


def importInTurns(name: str) -> Iterator[None]:
    """Import a module of ours; each step imports one, after those it imports at file scope."""
    if name in sys.modules:
        return
    spec = util.find_spec(name)
    source = getattr(spec and spec.loader, "get_source", lambda _name: "")(name)
    for module, names in _OURS.findall(source or ""):
        if module != name:
            yield from importInTurns(module)
        if hasattr(sys.modules.get(module), "__path__"):
            found = (f"{module}.{each}" for each in re.findall(r"\w+", names))
            for each in filter(util.find_spec, found):
                yield from importInTurns(each)
    import_module(name)
    yield
