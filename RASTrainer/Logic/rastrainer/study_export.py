"""What leaves a study about one trainee: everything as JSON, the trials as a CSV table."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rastrainer.files import write_text
from rastrainer.registration import RIGID
from rastrainer.study import Study
from rastrainer.study_values import StoredTrial, Trainee

FORMAT = "RASTrainer trainee 1"

HISTORY_COLUMNS = (
    "trainee",
    "trial",
    "started_utc",
    "scenario",
    "task",
    "mode",
    "completion_time_s",
    "rejected_touches",
    "undone_touches",
    "fre_mm",
    "expected_tre_mm",
    "true_tre_mm",
    "score",
    "score_version",
)


def export_trainee(study: Study, pseudonym: str, path: Path | str) -> int:
    """Write everything that a study holds about a trainee as one JSON file.

    Returns:
        The number of trials in it.

    Raises:
        InputError: the study has no such trainee, or the file cannot be written.
    """
    trainee, trials = study.trainee(pseudonym), study.history(pseudonym)
    document = {
        "format": FORMAT,
        "trainee": asdict(trainee),
        "trials": [_trial_json(trial) for trial in trials],
    }
    write_text(path, json.dumps(document, indent=2, allow_nan=False) + "\n")
    return len(trials)


def export_history(study: Study, pseudonyms: Iterable[str], path: Path | str) -> int:
    """Write the trials of trainees as a CSV file, one a row; return their number.

    Empty cells are unknown. Motion metrics follow the fixed columns.

    Raises:
        InputError: the study has no such trainee, or the file cannot be written.
    """
    rows = [
        (study.trainee(pseudonym), trial)
        for pseudonym in pseudonyms
        for trial in study.history(pseudonym)
    ]
    metrics = sorted({name for _trainee, trial in rows for name in trial.motion})
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([*HISTORY_COLUMNS, *metrics])
    for trainee, trial in rows:
        values = _history_row(trainee, trial)
        writer.writerow([*values, *(trial.motion.get(name, "") for name in metrics)])
    write_text(path, text.getvalue())
    return len(rows)


def _history_row(trainee: Trainee, trial: StoredTrial) -> Sequence[Any]:
    record, rigid, score = trial.record, trial.registrations.get(RIGID), trial.score
    values = (
        _cell(trainee.pseudonym),
        record.trial_id,
        record.started_utc,
        _cell(record.scenario),
        _cell(record.task),
        record.mode,
        record.completion_time_s,
        record.rejected_touches,
        record.undone_touches,
        None if rigid is None else rigid.fre_mm,
        None if rigid is None else rigid.expected_tre_mm,
        trial.true_tre_mm,
        None if score is None else score.score,
        None if score is None else score.version,
    )
    return ["" if value is None else value for value in values]


def _cell(text: str) -> str:
    """Return a text that a spreadsheet does not take for a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text


def _trial_json(trial: StoredTrial) -> dict[str, Any]:
    return {
        "record": trial.record.to_json(),
        "registrations": {kind: fit.to_json() for kind, fit in trial.registrations.items()},
        "score": None if trial.score is None else trial.score.to_json(),
        "true_tre_mm": trial.true_tre_mm,
        "head_to_world": trial.head_to_world,
        "motion": trial.motion,
    }
