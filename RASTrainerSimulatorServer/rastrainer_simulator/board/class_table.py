"""The table of a class: read periodically, away from the event loop, and put into words."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping
from typing import Any

from aiohttp import hdrs, web

from rastrainer.errors import InputError
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import (
    AssignmentStanding,
    CurriculumStanding,
    by_curriculum,
)
from rastrainer.study.curriculum.told_curriculum import ToldAssignment
from rastrainer.study.database.address import StudyPlace
from rastrainer.study.database.database import StudyBusyError
from rastrainer.study.database.values import utc_now
from rastrainer_simulator.board.class_reader import ClassReader, ClassStanding
from rastrainer_simulator.flow.session.curricula import AssignmentWords
from rastrainer_simulator.ops.study_thread import StudyThread
from rastrainer_simulator.ops.texts.texts import LANGUAGES, Texts

_log = logging.getLogger(__name__)
ROUND_S = 2.0
UNEXPECTED = "The study cannot be read because of an unexpected error; the board's log has more."


class ClassWatch:
    """Keeps what was last read of a study, also while it cannot be read."""

    def __init__(self, place: StudyPlace | None) -> None:
        """Read nothing yet, and without a study never."""
        self._thread = None if place is None else StudyThread(lambda: ClassReader(place))
        self._found: ClassStanding | None = None
        self._tables: dict[str, list[dict[str, Any]]] = {}
        self._problem = self._as_of = ""
        self._task: asyncio.Task[None] | None = None

    async def begin(self) -> None:
        """Read once, and from now on again and again.

        Raises:
            InputError: the study cannot be read, and waiting would not help.
        """
        if self._thread is None:
            return
        try:
            await self._read(self._thread)
        except StudyBusyError as error:
            self._problem = str(error)
        self._task = asyncio.create_task(self._keep_reading(self._thread))

    async def close(self) -> None:
        """Read no longer."""
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        if self._thread is not None:
            await self._thread.close()

    async def send(self, request: web.Request) -> web.Response:
        """Answer a page with the table in its language."""
        asked = request.query.get("language", "")
        language = asked if asked in LANGUAGES else next(iter(LANGUAGES))
        return web.json_response(self.message(language), headers={hdrs.CACHE_CONTROL: "no-store"})

    def message(self, language: str) -> dict[str, Any]:
        """Return what the page is sent, ready for JSON; docs/views.md says what each member is."""
        found = self._found
        if found is not None and language not in self._tables:
            self._tables[language] = class_table(found, language)
        return {
            "hasStudy": self._thread is not None,
            "problem": self._problem,
            "asOf": self._as_of,
            "curricula": self._tables.get(language, []),
            "without": [] if found is None else list(found.without),
        }

    async def _keep_reading(self, thread: StudyThread[ClassReader]) -> None:
        while True:
            await asyncio.sleep(ROUND_S)
            try:
                await self._read(thread)
            except InputError as error:
                self._problem = str(error)
            except Exception:
                # The seats are still to be seen.
                _log.exception(UNEXPECTED)
                self._problem = UNEXPECTED

    async def _read(self, thread: StudyThread[ClassReader]) -> None:
        found = await thread.do(ClassReader.read)
        if found is not self._found:
            self._found, self._tables = found, {}
        self._problem, self._as_of = "", utc_now()


def class_table(found: ClassStanding, language: str) -> list[dict[str, Any]]:
    """Return a table for each curriculum, ready for JSON; docs/views.md says what each member is.

    Args:
        found: Where everybody stands.
        language: Tag of `LANGUAGES`.
    """
    texts = Texts(LANGUAGES[language])

    def task_title(name: str) -> str:
        key = f"task.{name}"
        return texts.say(key) if key in texts else _spoken(name)

    words = AssignmentWords(texts, task_title, _spoken)
    groups = by_curriculum(found.standings)
    return [_table(curriculum, group, words) for curriculum, group in groups.items()]


def _table(
    curriculum: Curriculum, group: Mapping[str, CurriculumStanding], words: AssignmentWords
) -> dict[str, Any]:
    first = next(iter(group.values()))
    return {
        "title": curriculum.title,
        "assignments": [_column(each, words) for each in first.standings],
        "trainees": [_row(name, standing, words) for name, standing in group.items()],
    }


def _column(standing: AssignmentStanding, words: AssignmentWords) -> dict[str, Any]:
    told = ToldAssignment.of(standing)
    return {"name": told.name, "label": words.label(told), "goal": words.goal(told)}


def _row(name: str, standing: CurriculumStanding, words: AssignmentWords) -> dict[str, Any]:
    best = standing.next_best
    return {
        "trainee": name,
        "reached": standing.reached,
        "next": "" if best is None else words.label(ToldAssignment.of(best)),
        "cells": [_cell(each, words) for each in standing.standings],
    }


def _cell(standing: AssignmentStanding, words: AssignmentWords) -> dict[str, Any]:
    return {
        "state": standing.state.value,
        "progress": words.progress(ToldAssignment.of(standing)),
        "done": standing.done,
        "needed": standing.needed,
        "reachedUtc": standing.reached_utc,
    }


def _spoken(name: str) -> str:
    """Return the name of a task or procedure as people write it."""
    return name.replace("-", " ").capitalize()
