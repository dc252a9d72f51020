"""Where the study lies: a file of a fixed name in a folder that is made where it is missing."""

from __future__ import annotations

from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.study import Study

STUDY_FILE = "study.db"


def openStudyIn(folder: Path) -> Study:
    """Open the study in a folder, or begin one there.

    Raises:
        InputError: the folder cannot be made, or holds no study that can be used.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"The folder {folder} cannot be made: {error.strerror}.") from None
    return Study.open(folder / STUDY_FILE)
