"""Services for the logic of trials, and its conversations with the simulator."""

from __future__ import annotations

from collections.abc import Callable, Generator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.program.child_process import Run, runHere
from rastrainer.study.database.study import Study

T = TypeVar("T")


class Question(NamedTuple):
    """A command to the simulator; `yield` returns its answer's data, or raises its error."""

    command: str
    arguments: Mapping[str, Any]
    timeoutS: float = 5.0


Steps = Generator["Question | Callable[[], Any]", Any, Any]
"""Yields questions and functions; a function runs in the background, and `yield` returns its
result, or raises its error. All else runs on the main thread."""


@dataclass(frozen=True)
class TrialServices:
    """Services for the logic of trials.

    Scenarios are found and the study is opened, which may wait for a lock, in any thread. `records`
    is the folder of the simulator's journals, if it is on this computer; `run` runs the functions
    that register and score trials, and read journals.
    """

    scene: Any
    link: Link
    findScenario: Callable[[str], Scenario]
    openStudy: Callable[[], Study]
    work: BackgroundWork
    records: Path | None = None
    run: Run = runHere

    def runWanted(self, name: str, *arguments: Any) -> Any:
        return self.run(name, self.work.checkWanted, *arguments)

    def inStudy(self, do: Callable[[Study], T]) -> T:
        with self.openStudy() as study:
            return do(study)

    def converse(self, steps: Steps) -> None:
        """Go through steps; `process` of the link or the work raises their errors."""

        def proceed(resume: Callable[[Any], Any], value: Any) -> None:
            try:
                step = resume(value)
            except StopIteration:
                return
            if isinstance(step, Question):
                self.link.send(step.command, step.arguments, takeAnswer, step.timeoutS)
            else:
                self.work.do(step, partial(proceed, steps.send), partial(proceed, steps.throw))

        def takeAnswer(reply: Reply) -> None:
            if reply.ok:
                proceed(steps.send, reply.data)
            else:
                proceed(steps.throw, InputError(reply.error))

        proceed(steps.send, None)
