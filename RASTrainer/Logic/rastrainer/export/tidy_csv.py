"""One trial a row, one value a column: what R, Python and spreadsheets read at once."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from rastrainer.files import write_text
from rastrainer.report.study_data import StudyData, TrialRow, trial_rows
from rastrainer.study import Study

FIRST_COLUMNS = (
    *("trainee", "mode", "task", "number", "trial_id", "started_utc"),
    *("scenario", "score_version"),
)


def write_history(study: Study, pseudonyms: Iterable[str], path: Path | str) -> int:
    """Write all trials of trainees, trial runs too, as a CSV file; return their number.

    Raises:
        InputError: the study has no such trainee, or the file cannot be written.
    """
    rows = [row for pseudonym in pseudonyms for row in trial_rows(study.history(pseudonym))]
    write_text(path, trials_csv(rows))
    return len(rows)


def trials_csv(trials: Sequence[TrialRow]) -> str:
    """Return trials as CSV text; an empty cell is not known. Units end the columns' names."""
    names = sorted({name for trial in trials for name in trial.values})
    rows = [
        [
            *(plain_cell(text) for text in (trial.trainee, trial.mode, trial.task)),
            trial.number,
            trial.trial_id,
            trial.started_utc,
            plain_cell(trial.scenario),
            trial.score_version,
            *(_number(trial.values.get(name)) for name in names),
        ]
        for trial in trials
    ]
    return csv_text([*FIRST_COLUMNS, *names], rows)


def answers_csv(data: StudyData) -> str:
    """Return the questionnaires as CSV text, one score a row."""
    rows = [
        [
            plain_cell(answered.trainee),
            answered.step.mode,
            answered.step.name,
            answered.step.questionnaire,
            scale,
            _number(score),
        ]
        for answered in data.answers
        for scale, score in answered.scores.items()
    ]
    return csv_text(["trainee", "mode", "step", "questionnaire", "scale", "score"], rows)


def csv_text(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    """Return rows as CSV text."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def plain_cell(text: str) -> str:
    """Return a text that a spreadsheet does not take for a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@")) else text


def _number(value: float | None) -> str:
    return "" if value is None else repr(float(value))
