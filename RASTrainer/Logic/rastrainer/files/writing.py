"""Write files whole or not at all, and privately if they are about people.

Recordings of people are private: files 0600, folders 0700 (on Windows, the user's profile protects
them). Exports have the user's usual permissions.
"""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import stat
import uuid
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.reading import failure_reason, printable_name

OUR_FOLDERS = ("RASTrainer", "rastrainer")
"""Names of folders that we create for users."""
_FILE, _FOLDER = 0o600, 0o700
_OTHERS = 0o077


def write_text(path: str | os.PathLike[str], text: str, is_private: bool = False) -> None:
    """Write a UTF-8 text file as `write_bytes` does."""
    try:
        content = text.encode("utf-8")
    except ValueError as error:
        raise _unwritable(path, error) from None
    write_bytes(path, content, is_private)


def write_bytes(path: str | os.PathLike[str], content: bytes, is_private: bool = False) -> None:
    """Write a file atomically: after a crash there is the old or the new one.

    A private one is for this user only, unless its folder is shared (see `keep_others_out`).
    """
    target = Path(path)
    partial = target.parent / f".{uuid.uuid4().hex}.partial"
    try:
        is_own = is_private and not _is_shared(target)
        with open(partial, "xb", opener=open_private if is_own else None) as file:
            file.write(content)
            file.flush()
            os.fsync(file.fileno())
        if target.exists() and not is_own:
            shutil.copymode(target, partial)
        partial.replace(target)
    except (OSError, ValueError) as error:
        with contextlib.suppress(OSError, ValueError):
            partial.unlink()
        raise _unwritable(path, error) from None


def write_json(path: str | os.PathLike[str], value: object, is_private: bool = False) -> None:
    text = json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)
    write_text(path, text + "\n", is_private)


def rounded(value: Any, decimals: Mapping[str, int], key: str = "") -> Any:
    """Return JSON with the numbers of some keys, and of lists there, rounded to `decimals`."""
    if isinstance(value, dict):
        return {name: rounded(item, decimals, name) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [rounded(item, decimals, key) for item in value]
    return round(float(value), decimals[key]) + 0.0 if key in decimals else value


def make_folder(folder: Path, is_private: bool = False) -> None:
    """Make a folder and its missing parents, or as `make_private_folder` does."""
    try:
        if is_private:
            make_private_folder(folder)
        else:
            folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"The folder {folder} cannot be made: {error.strerror}.") from None


def make_empty_folder(folder: Path) -> None:
    make_folder(folder)
    if any(folder.iterdir()):
        raise InputError(f"The folder {folder} is not empty; choose an empty one.")


def write_private_json(path: Path, value: object) -> None:
    """Write JSON as `write_json` does, readable by this user only, and make its folder."""
    make_folder(path.parent, is_private=True)
    write_json(path, value, is_private=True)


def _unwritable(path: object, error: Exception) -> InputError:
    return InputError(
        f"The file {printable_name(path)} cannot be written: {failure_reason(error)}."
    )


def make_private_folder(folder: Path) -> None:
    """Make a folder and its missing parents for this user only; raise OSError if that fails.

    An existing folder is made private if its name or its parent's is in `OUR_FOLDERS`; the
    permissions of others are the user's choice.
    """
    missing = [place for place in (folder, *folder.parents) if not place.exists()]
    for place in reversed(missing):
        place.mkdir(_FOLDER, exist_ok=True)
    folder.mkdir(exist_ok=True)
    if {folder.name, folder.parent.name} & set(OUR_FOLDERS):
        keep_others_out(folder)


def open_private(path: str | os.PathLike[str], flags: int) -> int:
    """Open a file like `os.open`, also its errors, make it private, and return its descriptor."""
    descriptor = os.open(path, flags, _FILE)
    keep_others_out(path)
    return descriptor


def keep_others_out(path: str | os.PathLike[str]) -> None:
    """Remove other users' permissions on a file or folder.

    Another user's or a missing file is left unchanged, and so are files in a folder with the setgid
    bit, which shares them with a group.
    """
    if os.name != "posix":
        return
    path = Path(path)
    with contextlib.suppress(OSError):
        status = path.stat()
        is_open = status.st_uid == os.geteuid() and status.st_mode & _OTHERS
        if is_open and not _is_shared(path):
            path.chmod(stat.S_IMODE(status.st_mode) & ~_OTHERS)


def _is_shared(path: Path) -> bool:
    return bool(path.parent.stat().st_mode & stat.S_ISGID)
