"""The one thread that a study is for, which the event loop waits for."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

from rastrainer.study.database.address import StudyPlace
from rastrainer_simulator.lti.course_study import CourseStudy

T = TypeVar("T")


class StudyThread:
    """Does one thing after the other with a study, which is opened by the first."""

    def __init__(self, place: StudyPlace) -> None:
        self._place = place
        self._study: CourseStudy | None = None
        self._executor = ThreadPoolExecutor(1, "study")

    async def do(self, work: Callable[[CourseStudy], T]) -> T:
        """Return what a function returns for the study.

        Raises:
            InputError: the study cannot be opened, or as the function does.
        """
        return await asyncio.get_running_loop().run_in_executor(self._executor, self._run, work)

    def _run(self, work: Callable[[CourseStudy], T]) -> T:
        if self._study is None:
            self._study = CourseStudy(self._place)
        return work(self._study)

    async def close(self) -> None:
        """Close the study."""
        if self._study is not None:
            await self.do(CourseStudy.close)
        self._executor.shutdown()
