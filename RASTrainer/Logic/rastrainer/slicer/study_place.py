"""Where the study lies: a file whose folder is made where it is missing."""

from __future__ import annotations

from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.study import Study

STUDY_FILE = "study.db"


def openStudyIn(folder: Path) -> Study:
    """Open the study of the usual name in a folder, or begin one there.

    Raises:
        InputError: the folder cannot be made, or holds no study that can be used.
    """
    return openStudyFile(folder / STUDY_FILE)


def openStudyFile(path: Path) -> Study:
    """Open the study in a file, or begin one there.

    Raises:
        InputError: the folder cannot be made, or the file is no study that can be used.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"The folder {path.parent} cannot be made: {error.strerror}.") from None
    return Study.open(path)
