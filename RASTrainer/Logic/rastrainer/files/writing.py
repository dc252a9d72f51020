"""Writing files: whole or not at all, and for this user alone where they are about people.

What is recorded of people is private: files 0600, our folders 0700. On Windows the user's profile
protects them. What is exported, to be given to others, has the user's usual permissions.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import stat
import uuid
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.reading import failure_reason, printable_name


def write_text(path: str | os.PathLike[str], text: str) -> None:
    """Write a UTF-8 text file as `write_bytes` does.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        content = text.encode("utf-8")
    except ValueError as error:
        raise _unwritable(path, error) from None
    write_bytes(path, content)


def write_bytes(path: str | os.PathLike[str], content: bytes) -> None:
    """Write a file as a whole: after a crash the old or the new one is there.

    Raises:
        InputError: the file cannot be written.
    """
    target = Path(path)
    partial = target.parent / f".{uuid.uuid4().hex}.partial"
    try:
        with partial.open("xb") as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if target.exists():
            shutil.copymode(target, partial)
        partial.replace(target)
    except (OSError, ValueError) as error:
        with contextlib.suppress(OSError, ValueError):
            partial.unlink()
        raise _unwritable(path, error) from None


def make_empty_folder(folder: Path) -> None:
    """Make a folder; raise `InputError` where it cannot be made or holds something."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if any(folder.iterdir()):
            raise InputError(f"The folder {folder} holds something; choose one that is empty.")
    except OSError as error:
        raise InputError(f"The folder {folder} cannot be made: {error.strerror}.") from None


def _unwritable(path: object, error: Exception) -> InputError:
    return InputError(
        f"The file {printable_name(path)} cannot be written: {failure_reason(error)}."
    )


OUR_FOLDERS = ("RASTrainer", "rastrainer")
"""Names of folders that we make for users, and make others in."""
_FILE, _FOLDER = 0o600, 0o700
_OTHERS = 0o077


def make_private_folder(folder: Path) -> None:
    """Make a folder, and those above it that are missing, for this user alone.

    One that is there is closed to others where its name, or that of the one above, is of
    `OUR_FOLDERS`; any other is the user's own affair.

    Raises:
        OSError: it cannot be made.
    """
    missing = [place for place in (folder, *folder.parents) if not place.exists()]
    for place in reversed(missing):
        place.mkdir(_FOLDER, exist_ok=True)
    folder.mkdir(exist_ok=True)
    if {folder.name, folder.parent.name} & set(OUR_FOLDERS):
        keep_others_out(folder)


def open_private(path: str | os.PathLike[str], flags: int) -> int:
    """Open a file as `os.open` does, and keep other users out of it; return its descriptor.

    Raises:
        OSError: it cannot be opened.
    """
    descriptor = os.open(path, flags, _FILE)
    keep_others_out(path)
    return descriptor


def keep_others_out(path: str | os.PathLike[str]) -> None:
    """Take from other users what they may do with a file or folder.

    What is another's, or not there, stays as it is; so does what lies in a folder with the setgid
    bit, which somebody has set to share its files with a group.
    """
    if os.name != "posix":
        return
    path = Path(path)
    with contextlib.suppress(OSError):
        status = path.stat()
        is_shared = path.parent.stat().st_mode & stat.S_ISGID
        if status.st_uid == os.geteuid() and status.st_mode & _OTHERS and not is_shared:
            path.chmod(stat.S_IMODE(status.st_mode) & ~_OTHERS)
