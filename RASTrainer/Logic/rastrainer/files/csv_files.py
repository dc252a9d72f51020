"""Rows of a CSV file with a header, checked before anyone uses them."""

from __future__ import annotations

import csv
import io
import math
import os
from collections.abc import Sequence

from rastrainer.errors import InputError
from rastrainer.files.reading import read_text

LIMIT_BYTES = 4 * 2**20


def read_rows(
    path: str | os.PathLike[str], required: Sequence[str], optional: Sequence[str] = ()
) -> list[tuple[int, dict[str, str]]]:
    """Return the line number and the named cells of each row, stripped of spaces.

    Args:
        path: A CSV file in UTF-8, comma separated, of at most 4 MiB. Empty lines do not count.
        required: Columns that the header must name, in any order.
        optional: Columns that it may name; further ones are ignored.

    Raises:
        InputError: the file cannot be read, its header is another, a row has other cells than the
            header, or there is no row.
    """
    reader = csv.reader(io.StringIO(read_text(path, LIMIT_BYTES)), strict=True)
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
    path: object, line: int, cells: dict[str, str], column: str, lowest: float, highest: float
) -> float:
    """Return the number in a cell.

    Raises:
        InputError: it is no finite number from `lowest` to `highest`.
    """
    try:
        value = float(cells[column])
    except ValueError:
        value = math.nan
    if not lowest <= value <= highest:
        raise InputError(
            f"Line {line} of {path}: {column} must be a number from {lowest:g} to {highest:g}, "
            f"not {cells[column][:40]!r}."
        )
    return value
