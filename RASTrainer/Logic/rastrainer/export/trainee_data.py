"""What a trainee may ask for: a copy of everything about them, and its complete deletion."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from rastrainer.files.writing import write_text
from rastrainer.journal.folder import SUFFIX, erase_journals
from rastrainer.study.database.aborted_trials import AbortedTrials
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.protocol.study_progress import StudyProgress

FORMAT = "RASTrainer trainee 3"


def export_trainee(study: Study, pseudonym: str, path: Path | str) -> int:
    """Write everything that a study holds about a trainee as one JSON file.

    Returns:
        The number of finished trials in it.

    Raises:
        InputError: the study has no such trainee, or the file cannot be written.
    """
    trainee, trials = study.trainee(pseudonym), study.history(pseudonym)
    document = {
        "format": FORMAT,
        "trainee": asdict(trainee),
        "protocol": _protocol_json(StudyProgress(study), pseudonym),
        "trials": [_trial_json(trial) for trial in trials],
        "aborted_trials": [
            {
                "record": stored.record.to_json(),
                "step": stored.step,
                "repeat_reason": stored.repeat_reason,
            }
            for stored in AbortedTrials(study).of(pseudonym)
        ],
    }
    write_text(path, json.dumps(document, indent=2, allow_nan=False) + "\n")
    return len(trials)


def _protocol_json(progress: StudyProgress, pseudonym: str) -> dict[str, Any] | None:
    place = progress.enrolled().get(pseudonym)
    if place is None:
        return None
    return {"place": place, "steps": [asdict(e) for e in progress.progress(pseudonym).entries]}


def _trial_json(trial: StoredTrial) -> dict[str, Any]:
    return {
        "record": trial.record.to_json(),
        "registrations": {kind: fit.to_json() for kind, fit in trial.registrations.items()},
        "score": None if trial.score is None else trial.score.to_json(),
        "true_tre_mm": trial.true_tre_mm,
        "head_to_world": trial.head_to_world,
        "motion": trial.motion,
    }


@dataclass(frozen=True)
class Erasure:
    """What was deleted, and what may be left.

    Attributes:
        trials: How many finished ones were deleted from the study.
        journals: How many were deleted, of unfinished trials too.
        missing: UUIDs of the deleted trials, aborted ones too, whose journals were not there.
        unreadable: Journals that do not say whose they are.
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
    ids = [trial.record.trial_id for trial in study.history(pseudonym)]
    ids += [aborted.record.trial_id for aborted in AbortedTrials(study).of(pseudonym)]
    erased, unreadable = ((), ()) if records is None else erase_journals(records, pseudonym, ids)
    names = [path.name for path in erased]
    missing = [one for one in ids if not any(name.endswith(f"_{one}{SUFFIX}") for name in names)]
    trials = study.delete_trainee(pseudonym)
    return Erasure(trials, len(erased), tuple(missing), tuple(unreadable))
