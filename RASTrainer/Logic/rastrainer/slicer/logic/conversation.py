"""Questions to the simulator and background work that follow on each other, as one function."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from functools import partial
from typing import Any, NamedTuple

from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link


class Question(NamedTuple):
    """A command to the simulator; `yield` returns its answer's data, or raises its error."""

    command: str
    arguments: Mapping[str, Any]
    timeoutS: float = 5.0


Steps = Generator["Question | Callable[[], Any]", Any, Any]
"""Yields questions and functions; a function runs in the background, and `yield` returns its
result, or raises its error. Between them it runs on the main thread."""


def converse(link: Link, work: BackgroundWork, steps: Steps) -> None:
    """Go through steps; what they raise themselves is raised by `process` of link or work."""

    def proceed(resume: Callable[[Any], Any], value: Any) -> None:
        try:
            step = resume(value)
        except StopIteration:
            return
        if isinstance(step, Question):
            link.send(step.command, step.arguments, takeAnswer, step.timeoutS)
        else:
            work.do(step, partial(proceed, steps.send), partial(proceed, steps.throw))

    def takeAnswer(reply: Reply) -> None:
        if reply.ok:
            proceed(steps.send, reply.data)
        else:
            proceed(steps.throw, InputError(reply.error))

    proceed(steps.send, None)
