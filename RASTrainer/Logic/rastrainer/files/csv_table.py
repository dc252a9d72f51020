"""Tables in CSV files, as spreadsheets and 3D Slicer write them."""

from __future__ import annotations

import codecs
import contextlib
import csv
import math
import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rastrainer.errors import InputError
from rastrainer.files.reading import decode_text, read_bytes

CSV_LIMIT_BYTES = 4 * 2**20

POSITION_STATUS = "positionstatus"
"""The cell behind those that `.fcsv` names, which old versions of Slicer do not write."""

_DELIMITERS = ",;\t"
_SHOWN = 60
_SEPARATOR = re.compile(r"sep=([,;\t])", re.IGNORECASE)
"""The line by which a spreadsheet says what separates the cells."""
_COMMA_NUMBER = re.compile(r"[+-]?\d*,\d+(e[+-]?\d+)?", re.IGNORECASE)
_POINT_NUMBER = re.compile(r"[+-]?\d*\.\d+(e[+-]?\d+)?", re.IGNORECASE)


@dataclass(frozen=True)
class CsvTable:
    """The cells of a CSV file.

    `remarks` are what its first lines say as "# name = value", by name in lower case; `first` is
    the line that should be the header, as it is written; `header` has the names of the columns in
    lower case, `lines` the number and stripped cells of each further line that is not empty.
    """

    path: str | os.PathLike[str]
    remarks: Mapping[str, str]
    first: str
    header: tuple[str, ...]
    lines: tuple[tuple[int, list[str]], ...]

    def rows(
        self, required: Sequence[str], optional: Sequence[str] = ()
    ) -> list[tuple[int, dict[str, str]]]:
        """Return the line number and the named cells of each row.

        The header may have other columns, in any order. Decimal commas in required columns become
        points.
        """
        wanted = [*optional, *required]
        twice = next((name for name in wanted if self.header.count(name) > 1), None)
        if twice is not None:
            raise InputError(f"The file {self.path} has two columns {twice}.")
        if not set(required) <= set(self.header):
            raise InputError(
                f"The file {self.path} must be a CSV file with the header {','.join(wanted)}; its "
                f"first line is {self.first[:_SHOWN]!r}."
            )
        if not self.lines:
            raise InputError(f"The file {self.path} has a header but no rows.")
        columns = len(self.header)
        rows = []
        for number, cells in self.lines:
            if len(cells) < columns or any(cells[columns:]):
                hint = " A comma in a number needs semicolons between the cells, in a text quotes."
                raise InputError(
                    f"Line {number} of {self.path} has {len(cells)} cells; the header has "
                    f"{columns}.{hint if len(cells) > columns else ''}"
                )
            rows.append((number, dict(zip(self.header, cells, strict=False))))
        numbers = [cells[column] for _, cells in rows for column in required]
        comma = next(filter(_COMMA_NUMBER.fullmatch, numbers), None)
        point = next(filter(_POINT_NUMBER.fullmatch, numbers), None)
        if comma is not None and point is not None:
            raise InputError(
                f"The file {self.path} has numbers with commas and with points, {comma[:40]!r} and "
                f"{point[:40]!r}: write all with decimal points."
            )
        for _, named in rows:
            for column in required:
                if _COMMA_NUMBER.fullmatch(named[column]):
                    named[column] = named[column].replace(",", ".")
        return rows


def read_table(path: str | os.PathLike[str]) -> CsvTable:
    """Return the cells of a CSV file of at most 4 MiB.

    It may be in UTF-8 or, with its byte order mark, in UTF-16, and separated by commas, semicolons
    or tabs. A remark "# columns = …", as in Slicer's `.fcsv`, replaces the header.
    """
    content = read_bytes(path, CSV_LIMIT_BYTES)
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        with contextlib.suppress(UnicodeDecodeError):
            content = content.decode("utf-16").encode()
    text = decode_text(content, f"The file {path}")
    lines = text.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")
    remarks: dict[str, str] = {}
    start = 0
    while start < len(lines) and (lines[start].startswith("#") or not lines[start].strip()):
        name, _, value = lines[start].lstrip("# ").partition("=")
        remarks[name.strip().lower()] = value.strip()
        start += 1
    separator = _SEPARATOR.fullmatch(lines[start]) if start < len(lines) else None
    if separator:
        start += 1
    first = lines[start] if start < len(lines) else ""
    delimiter = separator[1] if separator else max(_DELIMITERS, key=first.count)
    reader = csv.reader(lines[start:], delimiter=delimiter, strict=True)
    try:
        read = [(start + reader.line_num, [cell.strip() for cell in row]) for row in reader]
    except csv.Error as error:
        raise InputError(
            f"The file {path} is not a CSV file: line {start + reader.line_num}: {error}."
        ) from None
    read = [(number, cells) for number, cells in read if any(cells)]
    if "columns" in remarks:
        header = [*remarks["columns"].split(delimiter), POSITION_STATUS]
        blank = [""] * len(header)
        read = [(number, [*cells, *blank][: len(header)]) for number, cells in read]
    else:
        header = read.pop(0)[1] if read else []
    while header and not header[-1].strip():
        header.pop()
    names = tuple(name.strip().lower() for name in header)
    return CsvTable(path, remarks, first, names, tuple(read))


def number_in(
    path: object, line: int, cells: dict[str, str], column: str, minimum: float, maximum: float
) -> float:
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
