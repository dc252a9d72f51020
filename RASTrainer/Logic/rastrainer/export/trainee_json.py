"""Everything that a study holds about one trainee, as one JSON file."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rastrainer.experiment.study_progress import StudyProgress
from rastrainer.files import write_text
from rastrainer.study import Study
from rastrainer.study_aborted import AbortedTrials
from rastrainer.study_values import StoredTrial

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
