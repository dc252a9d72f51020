"""The journals in a folder, and the files of tutorials beside them: find, read and erase them."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Callable, Collection, Iterator
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.finite_json import decode_finite_json
from rastrainer.journal.folder_lock import lock
from rastrainer.journal.journal_file import FIRST_BYTES, MAX_LINE_BYTES, read_journal
from rastrainer.journal.recording import Recording
from rastrainer.motion.trajectory import Trajectory

SUFFIX = ".journal"
TUTORIAL_SUFFIX = ".tutorial"
"""Of the files of tutorials: each is one line that names the trainee, like a journal's first."""
_ZEROS = bytes(1 << 20)


def journals(folder: Path) -> list[Path]:
    """Return the files of a folder that are journals by name and first bytes.

    Raises:
        InputError: there is no such folder.
    """
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder} with journals.")
    return [path for path in sorted(folder.glob(f"*{SUFFIX}")) if _begins_as_journal(path)]


def journals_of(folder: Path, trial_id: str) -> list[Path]:
    """Return the files named as a trial's journal: one or none."""
    return sorted(folder.glob(f"*_{trial_id}{SUFFIX}"))


def read_trajectory(
    folder: Path, trial_id: str, pause: Callable[[], None] = lambda: None
) -> Trajectory | None:
    """Return the trajectory of a trial, or None without a usable journal; `pause` as in
    `read_journal`.
    """
    for path in journals_of(folder, trial_id):
        with contextlib.suppress(InputError):
            return Recording.of(read_journal(path, pause).entries).trajectory()
    return None


def erase_journals(
    folder: Path, trainee: str, trial_ids: Collection[str] = ()
) -> tuple[list[Path], list[Path]]:
    """Overwrite and delete every journal and tutorial of a trainee, including damaged journals.

    Args:
        folder: Of the journals.
        trainee: Pseudonym; it is in a journal's first line.
        trial_ids: UUIDs of the trainee's trials, to identify journals by file name.

    Returns:
        The deleted paths, and those of files that name no trainee.

    Raises:
        InputError: there is no such folder, a journal cannot be deleted, or one is being written.
    """
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder} with journals.")
    erased, unreadable = [], []
    for path in sorted((*folder.glob(f"*{SUFFIX}"), *folder.glob(f"*{TUTORIAL_SUFFIX}"))):
        owner = _trainee_of(path)
        if owner == trainee or path.stem.rpartition("_")[2] in trial_ids:
            _erase(path)
            erased.append(path)
        elif owner is None:
            unreadable.append(path)
    return erased, unreadable


def _erase(path: Path) -> None:
    try:
        with _locked(path) as descriptor:
            _overwrite(descriptor)
        path.unlink()
    except OSError as error:
        raise InputError(
            f"The file {path} cannot be deleted ({error.strerror}); if the trial is still "
            "running, end it first."
        ) from None


def _begins_as_journal(path: Path) -> bool:
    with contextlib.suppress(OSError), path.open("rb") as file:
        return file.read(len(FIRST_BYTES)) == FIRST_BYTES
    return False


def _trainee_of(path: Path) -> str | None:
    """Return the trainee named in the first line, even if other lines are damaged."""
    with contextlib.suppress(OSError, ValueError, AttributeError), path.open("rb") as file:
        trainee = decode_finite_json(file.readline(MAX_LINE_BYTES).decode("ascii")).get("trainee")
        return trainee if isinstance(trainee, str) else None
    return None


@contextlib.contextmanager
def _locked(path: Path) -> Iterator[int]:
    descriptor = os.open(path, os.O_RDWR | getattr(os, "O_BINARY", 0))
    try:
        lock(descriptor)
        yield descriptor
    finally:
        os.close(descriptor)


def _overwrite(descriptor: int) -> None:
    left = os.fstat(descriptor).st_size
    os.lseek(descriptor, 0, os.SEEK_SET)
    while left > 0:
        left -= os.write(descriptor, _ZEROS[: min(left, len(_ZEROS))])
    os.fsync(descriptor)


_HEADER_BYTES = 512
_NUMBER = re.compile(rb'"kind":"header","format":"[a-z-]+","version":\d+,"number":(\d+),')


def newest_journal(folder: Path) -> Path | None:
    """Return the journal of the latest trial, or None.

    Trials of a folder are numbered, because a clock that is set back gives a later trial an earlier
    name. Unnumbered journals of older versions are ordered by name before the others.
    """
    paths = folder.glob(f"*{SUFFIX}")
    return max(paths, key=lambda path: (number_of(path), path.name), default=None)


def number_of(path: Path) -> int:
    """Return the number in a journal's header, or 0."""
    with contextlib.suppress(OSError), path.open("rb") as file:
        found = _NUMBER.search(file.read(_HEADER_BYTES))
        return int(found[1]) if found else 0
    return 0
