"""Where everybody in a study stands, read again only when the study has changed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.curriculum.standing import CurriculumStanding
from rastrainer.study.database.address import StudyPlace
from rastrainer.study.database.database import LockWait
from rastrainer.study.database.study import Study

MOST_TRAINEES = 500
LOCK_WAIT_S = 5.0


@dataclass(frozen=True)
class ClassStanding:
    """Where the active trainees of a study stand.

    Attributes:
        standings: Of those with a curriculum, by pseudonym.
        without: Who follows none.
    """

    standings: Mapping[str, CurriculumStanding]
    without: tuple[str, ...]


class ClassReader:
    """Reads a study and never changes it; for one thread.

    Each trainee is read in a transaction of a few milliseconds, so that no seat waits for it.
    """

    def __init__(self, place: StudyPlace) -> None:
        """Open nothing yet."""
        self._place = place
        self._study: Study | None = None
        self._version: int | None = None
        self._file: tuple[int, ...] = ()
        self._found: ClassStanding | None = None

    def read(self) -> ClassStanding:
        """Return where everybody stands; the same object as before where nothing has changed.

        Raises:
            InputError: the study cannot be read, or has too many active trainees.
            StudyBusyError: it cannot be read now.
        """
        try:
            return self._read()
        except InputError:
            # It is opened anew next time: it may have been restored meanwhile.
            self.close()
            raise

    def close(self) -> None:
        """Close the study."""
        if self._study is not None:
            self._study.close()
        self._study = self._found = None

    def _read(self) -> ClassStanding:
        file = _file(self._place)
        if self._study is None:
            self._study = Study.open_for_reading(self._place, LockWait(LOCK_WAIT_S))
        # Before anything is read: what changes meanwhile is read next time.
        version = self._study.database.version()
        is_same = version is not None and version == self._version
        if self._found is not None and is_same and file != self._file:
            # Another file has taken its place, or the open study is an old one's migrated copy.
            self.close()
            return self._read()
        if self._found is None or not is_same:
            self._found = _standing(self._study)
        self._version, self._file = version, file
        return self._found


def _file(place: StudyPlace) -> tuple[int, ...]:
    """Return numbers that change with a file; none for a database of PostgreSQL."""
    if not isinstance(place, Path):
        return ()
    try:
        found = place.stat()
    except OSError:
        raise InputError(f"There is no file {place}.") from None
    return found.st_ino, found.st_size, found.st_mtime_ns


def _standing(study: Study) -> ClassStanding:
    names = [trainee.pseudonym for trainee in study.trainees()]
    if len(names) > MOST_TRAINEES:
        raise InputError(
            f"The study has {len(names)} active trainees, and a table shows at most "
            f"{MOST_TRAINEES}: archive those who do not train any more."
        )
    standings = CurriculumStore(study).standings()
    without = tuple(name for name in names if name not in standings)
    return ClassStanding(standings, without)
