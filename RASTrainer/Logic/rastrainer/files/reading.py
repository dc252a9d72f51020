"""Read untrusted files as text or JSON: only regular files of limited size."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from rastrainer.errors import InputError
from rastrainer.json_checks import check_of, decode_finite_json, text
from rastrainer.json_records import record_from_json

T = TypeVar("T")


def read_bytes(path: str | os.PathLike[str], limit_bytes: int) -> bytes:
    try:
        # Opening a pipe would wait for its writer.
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        with os.fdopen(os.open(path, flags), "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise InputError(f"{path} is not a regular file.")
            if status.st_size == 0:
                raise InputError(f"The file {path} is empty.")
            is_large = status.st_size > limit_bytes
            content = b"" if is_large else file.read(limit_bytes + 1)
            if is_large or len(content) > limit_bytes:
                raise InputError(
                    f"The file {path} is larger than {limit_bytes / 2**20:g} MiB, the most that is "
                    "read."
                )
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError(f"There is no file {path}.") from None
    except IsADirectoryError:
        raise InputError(f"{path} is a folder; a file is needed.") from None
    except (OSError, ValueError) as error:
        raise InputError(
            f"The file {printable_name(path)} cannot be read: {failure_reason(error)}."
        ) from None
    return content


def read_text(path: str | os.PathLike[str], limit_bytes: int) -> str:
    """Return the UTF-8 text of a file, without its byte order mark."""
    return decode_text(read_bytes(path, limit_bytes), f"The file {path}")


def decode_text(content: bytes, what: str) -> str:
    """Return UTF-8 text without its byte order mark; `what` starts the error message."""
    try:
        decoded = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{what} is not UTF-8 text; save it as UTF-8.") from None
    if "\0" in decoded:
        raise InputError(f"{what} is not a text file in UTF-8: it has bytes that are zero.")
    return decoded


def read_json(path: str | os.PathLike[str], limit_bytes: int) -> Any:
    """Return the decoded JSON of a file; its numbers are finite."""
    content = read_text(path, limit_bytes)
    try:
        return decode_finite_json(content)
    except ValueError:
        raise InputError(f"The file {path} is not JSON with finite numbers.") from None


MAX_RECORD_BYTES = 2**20


def read_record(kind: type[T], path: Path) -> T:
    """Return the record of a dataclass `kind` in a JSON file; errors begin with the file's path."""
    return record_from_json(kind, read_json(path, MAX_RECORD_BYTES), str(path))


def format_version(version: int) -> Callable[[Any], int]:
    words = f"{version}, which this version reads"
    return check_of(lambda value: not isinstance(value, bool) and value == version, words, int)


_OUTSIDE = "the path of a file inside the scenario's folder"


def relative_path(value: Any) -> Path:
    """Accept the path of a file within the folder of the file that names it."""
    path = Path(text(200)(value))
    if "\\" in value or path.is_absolute() or ".." in path.parts or not path.name:
        raise ValueError(_OUTSIDE)
    return path


def path_beside(file: Path, relative: Path, key: str) -> Path:
    """Return the path that a file names by a key, symbolic links followed; it need not exist."""
    folder = file.parent.resolve()
    path = (folder / relative).resolve()
    if not path.is_relative_to(folder):
        raise InputError(f"{file}: {key} must be {_OUTSIDE}.")
    return path


def failure_reason(error: Exception) -> str:
    strerror = getattr(error, "strerror", None)
    return strerror.lower() if strerror else "its name is not valid"


def printable_name(path: object) -> str:
    """Return a path for a sentence; characters that cannot be printed are escaped."""
    return ascii(str(path)) if not str(path).isprintable() else str(path)
