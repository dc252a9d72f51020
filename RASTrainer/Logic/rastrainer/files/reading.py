"""Reading files that may hold anything: only regular files, of limited size, as text or JSON."""

from __future__ import annotations

import os
import stat
from typing import Any

from rastrainer.errors import InputError
from rastrainer.finite_json import decode_finite_json


def read_bytes(path: str | os.PathLike[str], limit_bytes: int) -> bytes:
    """Return what a file holds.

    Raises:
        InputError: no such file, no regular file, not readable, empty, or larger than the limit
            (checked before it is read).
    """
    try:
        # Opening a pipe would wait for its writer.
        flags = os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        with os.fdopen(os.open(path, flags), "rb") as file:
            _check_kind(path, os.fstat(file.fileno()), limit_bytes)
            content = file.read(limit_bytes + 1)
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
    if len(content) > limit_bytes:
        raise _too_large(path, limit_bytes)
    return content


def read_text(path: str | os.PathLike[str], limit_bytes: int) -> str:
    """Return the UTF-8 text of a file, without its byte order mark.

    Raises:
        InputError: as `read_bytes`, or not UTF-8 text.
    """
    return decode_text(read_bytes(path, limit_bytes), f"The file {path}")


def decode_text(content: bytes, what: str) -> str:
    """Return UTF-8 text without its byte order mark; `what` begins the sentence of an error.

    Raises:
        InputError: not UTF-8 text.
    """
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{what} is not UTF-8 text.") from None
    if "\0" in text:
        raise InputError(f"{what} is not a text file.")
    return text


def read_json(path: str | os.PathLike[str], limit_bytes: int) -> Any:
    """Return the decoded JSON of a file; its numbers are finite.

    Raises:
        InputError: as `read_text`, or the text is not JSON, too deeply nested or holds NaN.
    """
    text = read_text(path, limit_bytes)
    try:
        return decode_finite_json(text)
    except ValueError:
        raise InputError(f"The file {path} is not JSON with finite numbers.") from None


def _check_kind(path: object, status: os.stat_result, limit_bytes: int) -> None:
    if stat.S_ISDIR(status.st_mode):
        raise InputError(f"{path} is a folder; a file is needed.")
    if not stat.S_ISREG(status.st_mode):
        raise InputError(f"{path} is not a regular file.")
    if status.st_size > limit_bytes:
        raise _too_large(path, limit_bytes)
    if status.st_size == 0:
        raise InputError(f"The file {path} is empty.")


def _too_large(path: object, limit_bytes: int) -> InputError:
    return InputError(
        f"The file {path} is larger than {limit_bytes / 2**20:g} MiB, the most that is read."
    )


def failure_reason(error: Exception) -> str:
    """Return the system's words for why a file cannot be used."""
    strerror = getattr(error, "strerror", None)
    return strerror.lower() if strerror else "its name is not valid"


def printable_name(path: object) -> str:
    """Return a path for a sentence, escaped where it holds what cannot be printed."""
    return ascii(str(path)) if not str(path).isprintable() else str(path)
