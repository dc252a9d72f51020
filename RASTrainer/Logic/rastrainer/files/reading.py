"""Read untrusted files: only regular ones of limited size, as text, JSON, XML or CSV."""

from __future__ import annotations

import csv
import io
import math
import os
import re
import stat
from collections.abc import Sequence
from typing import Any
from xml.parsers import expat

from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json


def read_bytes(path: str | os.PathLike[str], limit_bytes: int) -> bytes:
    """Return the content of a file.

    Raises:
        InputError: missing, not a regular file, unreadable, empty, or larger than the limit, which
            is checked before reading.
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
    """Return UTF-8 text without its byte order mark; `what` starts the error message.

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
    """Return the system's description of a failure."""
    strerror = getattr(error, "strerror", None)
    return strerror.lower() if strerror else "its name is not valid"


def printable_name(path: object) -> str:
    """Return a path for a sentence, escaped where it holds what cannot be printed."""
    return ascii(str(path)) if not str(path).isprintable() else str(path)


MAX_ELEMENTS = 20_000
MAX_DEPTH = 64

_DECLARATION = re.compile(r"\s*<\?xml\s[^>]*\?>")


def plain_xml(content: bytes, what: str) -> str:
    """Return untrusted XML without its declaration, safe for any parser.

    The declaration could name an encoding in which the rest reads differently. `what` starts the
    error message, such as "The URDF robot.urdf".

    Raises:
        InputError: not UTF-8, not well-formed, too deep, too many elements, or with a document type
            or entities, which could expand without end or name other files.
    """
    text = decode_text(content, what)
    declaration = _DECLARATION.match(text)
    body = text[declaration.end() :] if declaration else text
    try:
        _Check(what).parse(body.encode())
    except expat.ExpatError as error:
        raise InputError(f"{what} is not well-formed XML: {error}.") from None
    return body


class _Check:
    """Checks each element as it is parsed."""

    def __init__(self, what: str) -> None:
        self._what = what
        self._elements = 0
        self._depth = 0

    def parse(self, body: bytes) -> None:
        parser = expat.ParserCreate("utf-8")
        parser.StartElementHandler = self._begin
        parser.EndElementHandler = self._end
        parser.StartDoctypeDeclHandler = self._refuse_type
        parser.Parse(body, True)

    def _begin(self, _name: str, _attributes: Any) -> None:
        self._elements += 1
        self._depth += 1
        if self._elements > MAX_ELEMENTS:
            raise InputError(f"{self._what} has more than {MAX_ELEMENTS} elements.")
        if self._depth > MAX_DEPTH:
            raise InputError(f"{self._what} nests its elements more than {MAX_DEPTH} deep.")

    def _end(self, _name: str) -> None:
        self._depth -= 1

    def _refuse_type(self, *_declaration: Any) -> None:
        raise InputError(f"{self._what} declares a document type or entities; remove them.")


CSV_LIMIT_BYTES = 4 * 2**20


def read_rows(
    path: str | os.PathLike[str], required: Sequence[str], optional: Sequence[str] = ()
) -> list[tuple[int, dict[str, str]]]:
    """Return the line number and the named, stripped cells of each row of a CSV file.

    Args:
        path: UTF-8, comma-separated, at most 4 MiB; empty lines are ignored.
        required: Columns that the header must have, in any order.
        optional: Columns that it may have; others are ignored.

    Raises:
        InputError: the file is unreadable or empty, its header is wrong, or a row does not match
            it.
    """
    reader = csv.reader(io.StringIO(read_text(path, CSV_LIMIT_BYTES)), strict=True)
    try:
        lines = [(reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise InputError(
            f"The file {path} is not a CSV file: line {reader.line_num}: {error}."
        ) from None
    lines = [(number, cells) for number, cells in lines if any(cells)]
    wanted = ",".join([*optional, *required] if optional else required)
    header = [name.lower() for name in lines[0][1]] if lines else []
    if not set(required) <= set(header) or len(set(header)) < len(header):
        raise InputError(f"The file {path} must be a CSV file with the header {wanted}.")
    if len(lines) == 1:
        raise InputError(f"The file {path} has a header but no rows.")
    rows = []
    for number, cells in lines[1:]:
        if len(cells) != len(header):
            raise InputError(
                f"Line {number} of {path} has {len(cells)} cells; the header has {len(header)}."
            )
        rows.append((number, dict(zip(header, cells, strict=True))))
    return rows


def number_in(
    path: object, line: int, cells: dict[str, str], column: str, minimum: float, maximum: float
) -> float:
    """Return the number in a cell.

    Raises:
        InputError: it is not a finite number from `minimum` to `maximum`.
    """
    try:
        value = float(cells[column])
    except ValueError:
        value = math.nan
    if not minimum <= value <= maximum:
        raise InputError(
            f"Line {line} of {path}: {column} must be a number from {minimum:g} to {maximum:g}, "
            f"not {cells[column][:40]!r}."
        )
    return value
