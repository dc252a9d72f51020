"""The complete deletion of one trainee: from the study's file and from the journals."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rastrainer.journal.folder import erase_journals
from rastrainer.study import Study


@dataclass(frozen=True)
class Erasure:
    """How many trials and how many journals were deleted."""

    trials: int
    journals: int


def erase_trainee(study: Study, pseudonym: str, records: Path | None) -> Erasure:
    """Delete a trainee for good.

    The journals go first: if one cannot be deleted, the trainee is still in the study and the
    deletion can be repeated. Exports that were made before are the lab's to delete.

    Args:
        study: In which the trainee is.
        pseudonym: Of the trainee.
        records: Folder of the simulator's journals; None where they are elsewhere.

    Raises:
        InputError: there is no such trainee, or a journal cannot be deleted.
    """
    study.trainee(pseudonym)
    journals = 0 if records is None else erase_journals(records, pseudonym)
    return Erasure(study.delete_trainee(pseudonym), journals)
