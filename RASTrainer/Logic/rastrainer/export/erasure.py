"""The complete deletion of one trainee: from the study's file and from the journals."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rastrainer.journal.folder import SUFFIX, erase_journals
from rastrainer.study import Study
from rastrainer.study_aborted import AbortedTrials


@dataclass(frozen=True)
class Erasure:
    """What was deleted, and what may be left.

    Attributes:
        trials: How many finished ones were deleted from the study.
        journals: How many were deleted, of unfinished trials too.
        missing: UUIDs of the deleted trials, aborted ones too, whose journals were not there.
        unreadable: Journals that do not tell whose they are.
    """

    trials: int
    journals: int
    missing: tuple[str, ...] = ()
    unreadable: tuple[Path, ...] = ()

    @property
    def warnings(self) -> tuple[str, ...]:
        """One sentence for each kind of thing that may be left; none where nothing is."""
        sentences = []
        if self.missing:
            names = ", ".join(f"*_{trial_id}{SUFFIX}" for trial_id in self.missing)
            sentences.append(
                f"The journals of {len(self.missing)} trials were not found; where another "
                f"computer has recorded them, delete them there: {names}."
            )
        if self.unreadable:
            paths = ", ".join(str(path) for path in self.unreadable)
            sentences.append(f"Whose journals these are cannot be read, they are left: {paths}.")
        return tuple(sentences)


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
    kept = (*study.history(study.trainee(pseudonym).pseudonym), *AbortedTrials(study).of(pseudonym))
    ids = [trial.record.trial_id for trial in kept]
    erased, unreadable = ((), ()) if records is None else erase_journals(records, pseudonym, ids)
    names = [path.name for path in erased]
    missing = [one for one in ids if not any(name.endswith(f"_{one}{SUFFIX}") for name in names)]
    trials = study.delete_trainee(pseudonym)
    return Erasure(trials, len(erased), tuple(missing), tuple(unreadable))
