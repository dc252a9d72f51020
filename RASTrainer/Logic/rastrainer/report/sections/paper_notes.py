"""A published study's printed numbers beside ours, its inconsistencies, and its claims."""

from __future__ import annotations

import numpy as np

from rastrainer.number_text import counted, fixed, significant
from rastrainer.report.markup import Cell, bullets, heading, paragraph, section, table
from rastrainer.report.published_scores import cohort_scores
from rastrainer.report.study_data import StudyData
from rastrainer.report.study_notes import Printed


def paper_notes(data: StudyData) -> str:
    """Return the section; "" for a study without notes."""
    notes = data.notes
    if notes is None:
        return ""
    rows = [
        [
            printed.what,
            _count(data, printed),
            printed.printed,
            _ours(data, printed),
        ]
        for printed in notes.printed
    ]
    claims = [[Cell(claim, kind="text"), Cell(words, kind="text")] for claim, words in notes.claims]
    return section(
        "The paper's numbers, checked",
        paragraph(f"Source: {notes.source}."),
        table([["what", "n", "printed", "from the trials"]], rows),
        heading("What does not fit"),
        bullets(notes.inconsistencies),
        heading("The claims"),
        table([[Cell("The paper says", kind="text"), Cell("The trials say", kind="text")]], claims),
    )


def _count(data: StudyData, printed: Printed) -> str:
    """Return what a number is computed from, and how many there are."""
    trials = data.ctps_trials(printed.mode)
    if printed.quantity in ("pearson_r", "r_squared"):
        return counted(len({trial.task for trial in trials}), "task mean")
    return counted(len(trials), "trial")


def _ours(data: StudyData, printed: Printed) -> str:
    trials = data.ctps_trials(printed.mode)
    scores = cohort_scores(data, printed.mode)
    if scores is None:
        return "–"
    if printed.quantity == "mean_ct":
        value = float(np.mean([trial.completion_time_s for trial in trials]))
    elif printed.quantity == "mean_rmse":
        value = float(np.mean([trial.rmse_mm for trial in trials]))
    else:
        value = getattr(scores, printed.quantity)
    if value is None:
        return "–"
    return significant(value, 4) if abs(value) < 1 else fixed(value, 3)
