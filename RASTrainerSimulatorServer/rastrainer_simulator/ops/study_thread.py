"""The one thread that uses a study, for which the event loop waits."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Generic, Protocol, TypeVar


class OpenedStudy(Protocol):
    """Work on a study; for one thread."""

    def close(self) -> None:
        """Close the study."""


Opened = TypeVar("Opened", bound=OpenedStudy)
T = TypeVar("T")


class StudyThread(Generic[Opened]):
    """Does one job after the other with a study, which is opened by the first."""

    def __init__(self, open_study: Callable[[], Opened]) -> None:
        """Open nothing yet; `open_study` is called in the thread, and may raise `InputError`."""
        self._open = open_study
        self._study: Opened | None = None
        self._executor = ThreadPoolExecutor(1, "study")

    async def do(self, work: Callable[[Opened], T]) -> T:
        return await asyncio.get_running_loop().run_in_executor(self._executor, self._run, work)

    def _run(self, work: Callable[[Opened], T]) -> T:
        if self._study is None:
            self._study = self._open()
        return work(self._study)

    async def close(self) -> None:
        if self._study is not None:
            await self.do(lambda study: study.close())
        self._executor.shutdown()
