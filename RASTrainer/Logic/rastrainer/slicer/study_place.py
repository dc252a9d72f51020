"""Where the study lies: a file whose folder is made where it is missing."""

from __future__ import annotations

from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.private_files import make_private_folder
from rastrainer.study import Study
from rastrainer.study_patience import Patience

STUDY_FILE = "study.db"


def openStudyIn(folder: Path) -> Study:
    """Open the study of the usual name in a folder, or begin one there.

    Raises:
        InputError: the folder cannot be made, or holds no study that can be used.
    """
    return openStudyFile(folder / STUDY_FILE)


def openStudyFile(path: Path, patience: Patience | None = None) -> Study:
    """Open the study in a file, or begin one there.

    Args:
        path: of the file.
        patience: with a lock held elsewhere; half a minute when left out.

    Raises:
        InputError: the folder cannot be made, or the file is no study that can be used.
        StudyBusyError: another program has it locked.
    """
    try:
        make_private_folder(path.parent)
    except OSError as error:
        raise InputError(f"The folder {path.parent} cannot be made: {error.strerror}.") from None
    return Study.open(path, patience)
