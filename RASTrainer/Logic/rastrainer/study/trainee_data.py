"""A trainee's right to their data: a complete copy, and complete deletion."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rastrainer.files.writing import write_json
from rastrainer.journal.folder import TUTORIAL_SUFFIX, erase_journals
from rastrainer.json_records import record_to_json
from rastrainer.study.curriculum.curriculum_store import CurriculumStore
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.ratings import RatingStore

FORMAT = "RASTrainer trainee 1"


def export_trainee(study: Study, pseudonym: str, path: Path | str) -> int:
    trainee, trials = study.trainee(pseudonym), study.history(pseudonym)
    progress, protocol = StudyProgress(study), None
    place = progress.enrolled().get(pseudonym)
    if place is not None:
        entries = progress.progress(pseudonym).entries
        protocol = {"place": place, "steps": [record_to_json(entry) for entry in entries]}
    aborted = study.aborted(pseudonym)
    document = {
        "format": FORMAT,
        "trainee": record_to_json(trainee),
        "protocol": protocol,
        "trials": [record_to_json(trial, with_defaults=True) for trial in trials],
        "abortedTrials": [
            {
                "record": record_to_json(record, with_defaults=True),
                "step": record.step,
                "repeatReason": record.repeat_reason,
            }
            for record in aborted
        ],
        "drills": [record_to_json(drill, with_defaults=True) for drill in study.drills(pseudonym)],
        "curricula": [
            {
                "curriculum": None if curriculum is None else curriculum.to_json(),
                "storedUtc": stored_utc,
            }
            for name, curriculum, stored_utc in CurriculumStore(study).choices()
            if name == pseudonym
        ],
        "ratings": [
            {"trialId": rating.trial_id, "form": rating.form, "marks": dict(rating.marks)}
            for rating in RatingStore(study).ratings()
            if rating.trial_id in {trial.record.trial_id for trial in trials}
        ],
    }
    write_json(path, document)
    return len(trials)


@dataclass(frozen=True)
class Erasure:
    """Numbers of deleted trials and journals, unfinished trials included, and possible remains.

    Missing are UUIDs of deleted trials whose journals were not found; unreadable journals name no
    trainee.
    """

    trials: int
    journals: int
    missing: tuple[str, ...] = ()
    unreadable: tuple[Path, ...] = ()

    @property
    def warnings(self) -> tuple[str, ...]:
        sentences = []
        if self.missing:
            names = ", ".join(f"*_{trial_id}.*" for trial_id in self.missing)
            sentences.append(
                f"The journals of {len(self.missing)} trials were not found; where another "
                f"computer has recorded them, delete them there: {names}."
            )
        if self.unreadable:
            paths = ", ".join(str(path) for path in self.unreadable)
            sentences.append(f"These journals do not say whose they are, and are left: {paths}.")
        return tuple(sentences)


def erase_trainee(study: Study, pseudonym: str, records: Path | None) -> Erasure:
    """Delete a trainee permanently.

    Journals and files of tutorials, in the folder `records` if they are here, are deleted first: if
    one cannot be deleted, the trainee remains and the deletion can be repeated. Earlier exports
    must be deleted by the lab.
    """
    ids = [trial.record.trial_id for trial in study.history(pseudonym)]
    ids += [aborted.trial_id for aborted in study.aborted(pseudonym)]
    ids += [drill.trial_id for drill in study.drills(pseudonym)]
    erased, unreadable = ((), ()) if records is None else erase_journals(records, pseudonym, ids)
    stems = [path.stem for path in erased if path.suffix != TUTORIAL_SUFFIX]
    missing = [one for one in ids if not any(stem.endswith(f"_{one}") for stem in stems)]
    trials = study.delete_trainee(pseudonym)
    return Erasure(trials, len(stems), tuple(missing), tuple(unreadable))
