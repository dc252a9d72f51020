"""The table of a class: read whenever the study has changed, and phrased in words."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from aiohttp import web

from rastrainer.errors import InputError
from rastrainer.json_records import record_to_json
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import CurriculumStanding, by_curriculum
from rastrainer.study.database.database import LockWait, StudyBusyError, StudyPlace
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import utc_now
from rastrainer.study.outcomes import task_title
from rastrainer_simulator.board.board_messages import (
    AssignmentCell,
    AssignmentColumn,
    ClassNews,
    CurriculumTable,
    TraineeRow,
)
from rastrainer_simulator.flow.session.assigned_training import AssignmentTexts
from rastrainer_simulator.net.views.access_control import fresh_json
from rastrainer_simulator.texts.texts import LANGUAGES, Texts

MOST_TRAINEES = 500
LOCK_WAIT_S = 5.0
ROUND_S = 2.0
UNEXPECTED = "The study cannot be read because of an unexpected error; the board's log has more."
_log = logging.getLogger(__name__)
Standings = Mapping[str, "CurriculumStanding | None"]
"""Standings of the active trainees of a study, by name; None without a curriculum."""


class ClassReader:
    """Reads a study and never changes it; for one thread.

    Each trainee is read in a transaction of a few milliseconds, so that no seat waits for it.
    """

    def __init__(self, place: StudyPlace) -> None:
        self._place = place
        self._study: Study | None = None
        self._version: int | None = None
        self._file: tuple[int, ...] = ()
        self._found: Standings | None = None

    def read(self) -> Standings:
        """Return everybody's standing; the same object as before if nothing has changed."""
        try:
            file = _file(self._place)
            if self._study is None:
                self._study = Study.open_for_reading(self._place, LockWait(LOCK_WAIT_S))
            # Before anything is read: what changes meanwhile is read next time.
            version = self._study.database.version()
            is_same = version is not None and version == self._version
            if self._found is not None and is_same and file != self._file:
                # Another file has taken its place, or the open study is an old one's migrated copy.
                self.close()
                return self.read()
            if self._found is None or not is_same:
                self._found = _standing(self._study)
        except InputError:
            # It is reopened next time: it may have been restored meanwhile.
            self.close()
            raise
        self._version, self._file = version, file
        return self._found

    def close(self) -> None:
        if self._study is not None:
            self._study.close()
        self._study = self._found = None


def _file(place: StudyPlace) -> tuple[int, ...]:
    if not isinstance(place, Path):
        return ()
    try:
        found = place.stat()
    except OSError:
        raise InputError(f"There is no file {place}.") from None
    return found.st_ino, found.st_size, found.st_mtime_ns


def _standing(study: Study) -> Standings:
    names = [trainee.pseudonym for trainee in study.trainees()]
    if len(names) > MOST_TRAINEES:
        raise InputError(
            f"The study has {len(names)} active trainees, and a table shows at most "
            f"{MOST_TRAINEES}: archive those who no longer train."
        )
    store = CurriculumStore(study)
    return {name: store.standing(name) for name in names}


class ClassWatch:
    """Keeps the standings that were last read, also while the study cannot be read."""

    def __init__(self, place: StudyPlace | None) -> None:
        self._reader = None if place is None else ClassReader(place)
        self._thread = ThreadPoolExecutor(1, "study")
        self._found: Standings | None = None
        self._tables: dict[str, tuple[CurriculumTable, ...]] = {}
        self._problem = self._as_of = ""
        self._task: asyncio.Task[None] | None = None

    async def begin(self) -> None:
        """Read once now, and repeatedly from now on."""
        if self._reader is None:
            return
        try:
            await self._read(self._reader)
        except StudyBusyError as error:
            self._problem = str(error)
        self._task = asyncio.create_task(self._keep_reading(self._reader))

    async def close(self) -> None:
        if self._task is not None:
            self._task.cancel()
            await asyncio.gather(self._task, return_exceptions=True)
        if self._reader is not None:
            self._thread.submit(self._reader.close)
        self._thread.shutdown()

    async def send(self, request: web.Request) -> web.Response:
        asked = request.query.get("language", "")
        language = asked if asked in LANGUAGES else next(iter(LANGUAGES))
        return fresh_json(record_to_json(self.message(language), with_defaults=True))

    def message(self, language: str) -> ClassNews:
        found = self._found
        if found is not None and language not in self._tables:
            self._tables[language] = class_table(found, language)
        return ClassNews(
            has_study=self._reader is not None,
            problem=self._problem,
            as_of=self._as_of,
            curricula=self._tables.get(language, ()),
            without=tuple(name for name, each in (found or {}).items() if each is None),
        )

    async def _keep_reading(self, reader: ClassReader) -> None:
        while True:
            await asyncio.sleep(ROUND_S)
            try:
                await self._read(reader)
            except InputError as error:
                self._problem = str(error)
            except Exception:
                # The seats must still be shown.
                _log.exception(UNEXPECTED)
                self._problem = UNEXPECTED

    async def _read(self, reader: ClassReader) -> None:
        found = await asyncio.get_running_loop().run_in_executor(self._thread, reader.read)
        if found is not self._found:
            self._found, self._tables = found, {}
        self._problem, self._as_of = "", utc_now()


def class_table(found: Standings, language: str) -> tuple[CurriculumTable, ...]:
    texts = Texts(LANGUAGES[language])

    def title(task: str) -> str:
        key = f"task.{task}"
        return texts.say(key) if key in texts else task_title(task)

    words = AssignmentTexts(texts, title, task_title)
    tables = []
    for curriculum, group in by_curriculum(found).items():
        first = next(iter(group.values()))
        columns = tuple(
            AssignmentColumn(each.name, words.label(each), words.goal(each))
            for each in first.standings
        )
        rows = tuple(_row(name, standing, words) for name, standing in group.items())
        tables.append(CurriculumTable(curriculum.title, columns, rows))
    return tuple(tables)


def _row(name: str, standing: CurriculumStanding, words: AssignmentTexts) -> TraineeRow:
    best = standing.next_best
    return TraineeRow(
        trainee=name,
        reached=standing.reached,
        next="" if best is None else words.label(best),
        cells=tuple(
            AssignmentCell(
                each.state, words.progress(each), each.done, each.needed, each.reached_utc
            )
            for each in standing.standings
        ),
    )
