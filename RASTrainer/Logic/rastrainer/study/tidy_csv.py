"""Tidy tables for R, Python and spreadsheets: one trial, touch, score or answer per row."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from pathlib import Path

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.decision.drill_rows import COLUMNS, cells, drill_rows
from rastrainer.errors import InputError
from rastrainer.files.writing import write_text
from rastrainer.procedure.errors import SplitError, TrajectoryErrors
from rastrainer.protocol import TRIAL_RUN
from rastrainer.registration.fits import RIGID
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.protocol.questionnaires import find_questionnaire
from rastrainer.study.protocol.study_progress import QuestionnaireAnswers
from rastrainer.study.study_data import StudyData, trial_rows
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import AbortedTrial
from rastrainer.trial.trial_row import TrialRow

FIRST_COLUMNS = (
    *("trainee", "mode", "task", "number", "trial_id", "started_utc"),
    *("scenario", "score_version", "method"),
)
TOUCH_COLUMNS = (
    *("trainee", "mode", "task", "number", "trial_id", "label"),
    *("sim_time_s", "x_mm", "y_mm", "z_mm", "residual_mm"),
)
ABORTED_COLUMNS = (
    *("trainee", "mode", "task", "trial_id", "started_utc", "aborted_utc", "scenario"),
    *("trial_run", "phase", "reason", "elapsed_s", "touches", "refused_touches", "undone_touches"),
    *("counts_as_not_passed", "step", "repeat_reason", "method", "traced_points"),
)
ABORTED_TOUCH_COLUMNS = (
    *("trainee", "mode", "task", "trial_id", "label"),
    *("sim_time_s", "x_mm", "y_mm", "z_mm"),
)
PROCEDURE_COLUMNS = (
    *("trainee", "mode", "task", "number", "trial_id", "procedure", "kind", "trajectory"),
    *("aligned_by", "entry_mm", "entry_by_registration_mm", "entry_by_hand_mm"),
    *("entry_by_robot_mm", "target_mm", "target_by_registration_mm", "target_by_hand_mm"),
    "target_by_robot_and_hand_mm",
    *("radial_mm", "depth_mm", "depth_by_registration_mm", "depth_by_hand_mm"),
    *("angle_deg", "angle_by_registration_deg", "angle_by_hand_deg", "angle_by_robot_deg"),
    *("plunge_mm", "nearest_no_go", "kept_mm", "alignments"),
    *("aligning_s", "drilling_s", "inserting_s", "procedure_score", "procedure_score_version"),
)
CASE_COLUMNS = ("trainee", "mode", "drill", "trial_id", "started_utc", "scenario", "case", *COLUMNS)
RATING_COLUMNS = ("trial_id", "rater", "form", "domain", "mark")
QUESTIONNAIRE_COLUMNS = ("trainee", "mode", "step", "questionnaire")


def write_history(study: Study, pseudonyms: Iterable[str], path: Path | str) -> int:
    """Write all trials of trainees, including trial runs, as CSV; return their number.

    Aborted trials go into a second file, `NAME-aborted.csv`, decided cases into `NAME-cases.csv`.
    """
    pseudonyms = tuple(pseudonyms)
    path = Path(path)
    rows = [row for pseudonym in pseudonyms for row in trial_rows(study.history(pseudonym))]
    write_text(path, trials_csv(rows))
    aborted = [stored for name in pseudonyms for stored in study.aborted(name)]
    drills = [drill for name in pseudonyms for drill in study.drills(name)]
    if aborted:
        write_text(path.with_name(f"{path.stem}-aborted{path.suffix}"), aborted_csv(aborted))
    if drills:
        write_text(path.with_name(f"{path.stem}-cases{path.suffix}"), cases_csv(drills))
    return len(rows)


def write_histories(study: Study, path: Path | str) -> tuple[int, int]:
    """Write all trials of consenting trainees, including trial runs, as CSV.

    Return the number of trials, and of trainees without consent, who are left out.
    """
    everyone = study.trainees(archived=None)
    consenting = sorted(trainee.pseudonym for trainee in everyone if trainee.consent)
    left_out = len(everyone) - len(consenting)
    if not consenting:
        raise InputError(f"No trainee of this study consented to research ({left_out} did not).")
    return write_history(study, consenting, path), left_out


def trials_csv(trials: Sequence[TrialRow]) -> str:
    """Return trials as CSV; unknown values are empty, column names end with the unit."""
    names = sorted({name for trial in trials for name in trial.values})
    rows = [
        [
            *(getattr(trial, name) for name in FIRST_COLUMNS),
            *(float(trial.values[name]) if name in trial.values else None for name in names),
        ]
        for trial in trials
    ]
    return csv_text([*FIRST_COLUMNS, *names], rows)


def aborted_csv(trials: Iterable[AbortedTrial]) -> str:
    rows = []
    for record in trials:
        when = record.started_utc, record.aborted_utc
        end = int(record.task == TRIAL_RUN), record.phase, record.reason, record.elapsed_s
        touches = len(record.points), record.rejected_touches, record.undone_touches
        repeat = int(record.counts_as_failed), record.step, record.repeat_reason
        method = record.method.value, record.traced
        first = *_who(record), record.trial_id, *when, record.scenario
        rows.append([*first, *end, *touches, *repeat, *method])
    return csv_text(ABORTED_COLUMNS, rows)


def aborted_touches_csv(trials: Iterable[AbortedTrial]) -> str:
    """Return the kept touches of aborted trials, like `touches_csv`."""
    rows = [
        [*_who(trial), trial.trial_id, point.label, point.sim_time_s, *point.position_mm]
        for trial in trials
        for point in trial.points
    ]
    return csv_text(ABORTED_TOUCH_COLUMNS, rows)


def touches_csv(trials: Iterable[tuple[TrialRow, StoredTrial]]) -> str:
    """Return the kept touches of trials as CSV, in order.

    Positions of the tip are in `World`; simulated times include pauses. Residuals are of the
    rigid fit, empty for points left out of it.
    """
    rows = []
    for trial, stored in trials:
        rigid = stored.registrations.get(RIGID)
        fitted = () if rigid is None else zip(rigid.labels, rigid.residuals_mm, strict=True)
        residuals = dict(fitted)
        for point in stored.record.points:
            touch = point.label, point.sim_time_s, *point.position_mm
            shared = *_who(trial), trial.number, trial.trial_id
            rows.append([*shared, *touch, residuals.get(point.label)])
    return csv_text(TOUCH_COLUMNS, rows)


def procedures_csv(trials: Iterable[TrialRow]) -> str:
    """Return the errors of procedures against the truth as CSV, one trajectory per row.

    Errors that are not due to the registration are in the columns of the hand if hands aligned the
    guide, and in the robot's columns if the robot did; then only the depth is by hand. Both parts
    of an error are lengths of vectors, which do not add up; depth errors do. A plunge depth is
    empty if the instrument missed the skull.
    """
    rows = [
        _procedure_cells(trial, trial.procedure, errors)
        for trial in trials
        if trial.procedure is not None
        for errors in trial.procedure.analysis.trajectories
    ]
    return csv_text(PROCEDURE_COLUMNS, rows)


def _procedure_cells(
    trial: TrialRow, done: ProcedureOutcome, errors: TrajectoryErrors
) -> list[object]:
    nearest = min(errors.kept_mm, key=errors.kept_mm.__getitem__, default="")

    def by_whom(others: float) -> list[float | None]:
        return [None, others] if errors.self_aligned else [others, None]

    def parts(error: SplitError) -> list[float | None]:
        return [error.mm, error.by_registration_mm, *by_whom(error.by_hand_mm)]

    return [
        *(*_who(trial), trial.number, trial.trial_id),
        *(done.analysis.procedure, done.analysis.kind.value, errors.trajectory),
        "robot" if errors.self_aligned else "hand",
        *parts(errors.entry_point_error),
        *parts(errors.target_point_error),
        errors.radial_error.mm,
        errors.depth_error_mm,
        errors.depth_error_by_registration_mm,
        errors.depth_error_by_hand_mm,
        errors.angular_deviation_deg,
        errors.angular_deviation_by_registration_deg,
        *by_whom(errors.angular_deviation_by_hand_deg),
        errors.plunge_mm,
        nearest,
        errors.kept_mm.get(nearest),
        errors.alignments,
        *(errors.times_s.get(phase) for phase in ("aligning", "drilling", "inserting")),
        done.score.score,
        done.score.version,
    ]


def cases_csv(drills: Sequence[DrillRecord]) -> str:
    """Return the decided cases of drills as CSV, in order; both are numbered from 1."""
    rows = [
        [
            *(drill.trainee, drill.mode, row.number, drill.trial_id, drill.started_utc),
            *(drill.scenario, number, *cells(case)),
        ]
        for drill, row in zip(drills, drill_rows(drills), strict=True)
        for number, case in enumerate(drill.cases, start=1)
    ]
    return csv_text(CASE_COLUMNS, rows)


def scores_csv(data: StudyData) -> str:
    rows = [
        [*_step_cells(answered), scale, score]
        for answered in data.answers
        for scale, score in answered.scores.items()
    ]
    return csv_text([*QUESTIONNAIRE_COLUMNS, "scale", "score"], rows)


def answers_csv(data: StudyData) -> str:
    rows = [
        [*_step_cells(answered), item.name, answer]
        for answered in data.answers
        for item, answer in zip(
            find_questionnaire(answered.step.questionnaire).items, answered.answers, strict=True
        )
    ]
    return csv_text([*QUESTIONNAIRE_COLUMNS, "item", "answer"], rows)


def ratings_csv(data: StudyData) -> str:
    rows = [
        [rating.trial_id, rating.rater, rating.form, domain, mark]
        for rating in data.ratings
        for domain, mark in sorted(rating.marks.items())
    ]
    return csv_text(RATING_COLUMNS, rows)


def _who(trial: TrialRow | AbortedTrial) -> tuple[str, str, str]:
    return trial.trainee, trial.mode, trial.task


def _step_cells(answered: QuestionnaireAnswers) -> tuple[str, ...]:
    step = answered.step
    return answered.trainee, step.mode, step.name, step.questionnaire


def csv_text(header: Sequence[str], rows: Iterable[Iterable[object]]) -> str:
    """Return rows as CSV text; None is empty, and no text is a formula for a spreadsheet."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    for row in rows:
        writer.writerow(
            f"'{cell}" if isinstance(cell, str) and cell.startswith(("=", "+", "-", "@")) else cell
            for cell in row
        )
    return text.getvalue()
