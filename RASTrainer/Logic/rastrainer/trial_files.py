"""Trials of a study from a CSV file with the header `mode,subject,task,ct,rmse`."""

from __future__ import annotations

import os

from rastrainer.csv_files import number_in, read_rows
from rastrainer.ctps import Trial
from rastrainer.errors import InputError

TEXT_LIMIT = 64
NUMBER_LIMIT = 1e6


def read_trials(path: str | os.PathLike[str]) -> list[Trial]:
    """Return the trials of a file, one a row: `ct` in s above 0, `rmse` in mm, 0 or above.

    Raises:
        InputError: the file cannot be used; the sentence says what would be right.
    """
    rows = read_rows(path, ("mode", "subject", "task", "ct", "rmse"))
    return [_trial(path, line, cells) for line, cells in rows]


def _trial(path: object, line: int, cells: dict[str, str]) -> Trial:
    for column in ("mode", "subject", "task"):
        if not 1 <= len(cells[column]) <= TEXT_LIMIT or not cells[column].isprintable():
            raise InputError(
                f"Line {line} of {path}: {column} must be printable text of 1 to {TEXT_LIMIT} "
                "characters."
            )
    completion_time = number_in(path, line, cells, "ct", 0, NUMBER_LIMIT)
    if completion_time == 0:
        raise InputError(f"Line {line} of {path}: ct must be above 0 s.")
    return Trial(
        mode=cells["mode"],
        subject=cells["subject"],
        task=cells["task"],
        completion_time_s=completion_time,
        rmse_mm=number_in(path, line, cells, "rmse", 0, NUMBER_LIMIT),
    )
