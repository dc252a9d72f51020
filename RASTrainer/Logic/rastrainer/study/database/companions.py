"""Where files go that belong to a study but must not be in it, such as what has been sent where."""

from __future__ import annotations

import hashlib
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.writing import make_private_folder
from rastrainer.study.database.address import StudyPlace


def beside_study(place: StudyPlace) -> Path:
    """Return the path whose name the names of such files begin with.

    That of the study's file; for a study in PostgreSQL one in the user's own folder, by its
    address.

    Raises:
        InputError: that folder cannot be made.
    """
    if isinstance(place, Path):
        return place
    folder = Path.home() / "RASTrainer" / "studies"
    try:
        make_private_folder(folder)
    except OSError as error:
        raise InputError(f"The folder {folder} cannot be made: {error.strerror}.") from None
    # Not by the role or the options: another one leads to the same study.
    where = f"{place.host}:{place.port or 5432}/{place.database}"
    return folder / hashlib.sha256(where.encode()).hexdigest()[:16]
