"""A folder of journals: which simulator records in it, and how its files are found and erased.

A simulator that records in a folder holds the lock of its lock file, which describes the simulator.
The lock ends with the process and is not inherited: while it is held, that process is running.
The folder also has the files of tutorials.
"""

from __future__ import annotations

import contextlib
import json
import os
import re
import sys
import uuid
from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from rastrainer.errors import InputError
from rastrainer.files.writing import open_private
from rastrainer.journal.journal_file import FIRST_BYTES, MAX_LINE_BYTES, SEED_SUFFIX
from rastrainer.json_checks import decode_finite_json, text, whole_number
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import NUMBER_LIMIT

if sys.platform == "win32":
    import msvcrt

    # Beyond the file's end, so that readers are not kept out.
    _FAR = 1 << 40

    def lock(descriptor: int) -> None:
        """Lock an open file until it is closed; raise OSError if another program holds the lock."""
        position = os.lseek(descriptor, 0, os.SEEK_CUR)
        os.lseek(descriptor, _FAR, os.SEEK_SET)
        msvcrt.locking(descriptor, msvcrt.LK_NBLCK, 1)
        os.lseek(descriptor, position, os.SEEK_SET)

else:
    import fcntl

    def lock(descriptor: int) -> None:
        """Lock an open file until it is closed; raise OSError if another program holds the lock."""
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)


def open_lock_file(path: Path) -> int:
    """Open a private file to be locked, made if it is missing; no child process inherits it."""
    return open_private(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0))


LOCK_NAME = ".simulator.lock"
MAX_LOCK_BYTES = 4096
STARTED_BY = "RASTRAINER_STARTED_BY"
"""Environment variable: the program that starts a simulator."""
_Text = Annotated[str, text(1000, 0)]


@dataclass(frozen=True)
class FolderHolder:
    """The simulator that holds a folder, with 0 and "" for unknown or missing values.

    `started` is UTC, ISO 8601, and `started_by` empty if a person started it. On host and port it
    listens for OpenIGTLink; `page` is the address of its page.
    """

    pid: Annotated[int, whole_number(0, 2**63)] = 0
    started: _Text = ""
    started_by: _Text = ""
    host: _Text = ""
    port: Annotated[int, whole_number(0, 65_535)] = 0
    page: _Text = ""


def write_holder(descriptor: int, holder: FolderHolder) -> None:
    """Write the holder into the open, locked lock file; raise OSError if that fails."""
    content = json.dumps(record_to_json(holder)).encode("ascii")
    os.lseek(descriptor, 0, os.SEEK_SET)
    os.write(descriptor, content)
    os.ftruncate(descriptor, len(content))


def read_holder(folder: Path) -> FolderHolder | None:
    """Return the simulator that records in a folder, or None if none is known."""
    try:
        descriptor = os.open(folder / LOCK_NAME, os.O_RDWR | getattr(os, "O_BINARY", 0))
    except OSError:
        return None
    try:
        # Only briefly: a simulator that is just starting tries again.
        lock(descriptor)
        return None
    except OSError:
        return read_open_holder(descriptor)
    finally:
        os.close(descriptor)


def read_open_holder(descriptor: int) -> FolderHolder:
    """Return the holder named in an open lock file."""
    with contextlib.suppress(OSError, ValueError):
        os.lseek(descriptor, 0, os.SEEK_SET)
        content = os.read(descriptor, MAX_LOCK_BYTES).decode("ascii")
        return record_from_json(FolderHolder, decode_finite_json(content))
    return FolderHolder()


SUFFIX = ".journal"
DRILL_SUFFIX = ".drill"
"""Ends the names of the journals of drills, so that no reader takes them for trials."""
TUTORIAL_SUFFIX = ".tutorial"
"""Ends the names of tutorials' files: each is one line that names the trainee, like a journal's
first."""
_ZEROS = bytes(1 << 20)


def journals(folder: Path) -> list[Path]:
    """Return the files of a folder that are journals by name and first bytes."""
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder} with journals.")
    found = []
    for path in sorted(folder.glob(f"*{SUFFIX}")):
        with contextlib.suppress(OSError), path.open("rb") as file:
            if file.read(len(FIRST_BYTES)) == FIRST_BYTES:
                found.append(path)
    return found


def journal_names(folder: Path) -> list[Path]:
    """Return the files of a folder that are journals of trials or drills by name."""
    return sorted((*folder.glob(f"*{SUFFIX}"), *folder.glob(f"*{DRILL_SUFFIX}")))


def journals_of(folder: Path, trial_id: str, suffix: str = SUFFIX) -> list[Path]:
    """Return the files named as the journal of a trial, or of a drill: one or none."""
    return sorted(folder.glob(f"*_{trial_id}{suffix}"))


def erase_journals(
    folder: Path, trainee: str, trial_ids: Collection[str] = ()
) -> tuple[list[Path], list[Path]]:
    """Overwrite and delete every journal and tutorial of a trainee, including damaged journals.

    A journal names the trainee in its first line, and its trial's UUID in the file's name. Return
    the deleted paths, and the paths of files that name no trainee.
    """
    if not folder.is_dir():
        raise InputError(f"There is no folder {folder} with journals.")
    erased, unreadable = [], []
    suffixes = SUFFIX, DRILL_SUFFIX, TUTORIAL_SUFFIX
    for path in sorted(path for suffix in suffixes for path in folder.glob(f"*{suffix}")):
        owner = _trainee_of(path)
        if owner == trainee or path.stem.rpartition("_")[2] in trial_ids:
            try:
                with path.open("r+b", buffering=0) as file:
                    lock(file.fileno())
                    left = os.fstat(file.fileno()).st_size
                    while left > 0:
                        left -= file.write(_ZEROS[: min(left, len(_ZEROS))])
                    os.fsync(file.fileno())
                path.unlink()
                path.with_suffix(SEED_SUFFIX).unlink(missing_ok=True)
            except OSError as error:
                raise InputError(
                    f"The file {path} cannot be deleted ({error.strerror}); if the trial is still "
                    "running, end it first."
                ) from None
            erased.append(path)
        elif owner is None:
            unreadable.append(path)
    return erased, unreadable


def _trainee_of(path: Path) -> str | None:
    """Return the trainee named in the first line, even if other lines are damaged."""
    with contextlib.suppress(OSError, ValueError, AttributeError), path.open("rb") as file:
        trainee = decode_finite_json(file.readline(MAX_LINE_BYTES).decode("ascii")).get("trainee")
        return trainee if isinstance(trainee, str) else None
    return None


_HEADER_BYTES = 512
_NUMBER = re.compile(
    rb'"kind":"header","format":"[a-z-]+","version":\d+,"number":(\d+),(?:"series":"([0-9a-f-]+)")?'
)


@dataclass(frozen=True, order=True)
class JournalNumber:
    """The number of a trial within its folder, from 1; earlier trials have smaller numbers.

    `series` is the UUID of the numbering, which begins with the first journal of a folder.
    """

    number: Annotated[int, whole_number(0, NUMBER_LIMIT)] = 0
    series: Annotated[str, text(36, 0)] = ""

    def following(self) -> JournalNumber:
        return JournalNumber(self.number + 1, self.series or str(uuid.uuid4()))


UNNUMBERED = JournalNumber()


def newest_journal(folder: Path, suffix: str = SUFFIX) -> Path | None:
    """Return the journal of the latest trial, or drill, or None.

    Trials of a folder are numbered, because a clock that is set back gives a later trial an earlier
    name; so are drills, apart from them.
    """
    paths = folder.glob(f"*{suffix}")
    return max(paths, key=lambda path: (number_of(path).number, path.name), default=None)


def number_of(path: Path) -> JournalNumber:
    """Return the number in a journal's header."""
    with contextlib.suppress(OSError), path.open("rb") as file:
        found = _NUMBER.search(file.read(_HEADER_BYTES))
        if found:
            return JournalNumber(int(found[1]), (found[2] or b"").decode("ascii"))
    return UNNUMBERED
