"""What the trainees answered."""

from __future__ import annotations

from collections import defaultdict

import numpy as np

from rastrainer.report.html.markup import Cell, Line, paragraph, section, table
from rastrainer.study.outcomes import mode_title
from rastrainer.study.questionnaires.catalog import QUESTIONNAIRES
from rastrainer.study.questionnaires.questionnaire import Scale
from rastrainer.study.study_data import StudyData


def questionnaires(data: StudyData) -> str:
    """Return a table of the scores by mode and occasion; "" where nobody was asked."""
    if not data.answers:
        return ""
    values: dict[tuple[str, str, str], list[float]] = defaultdict(list)
    for answered in data.answers:
        occasion = _occasion(answered.step.name, answered.step.mode)
        for scale, score in answered.scores.items():
            values[answered.step.questionnaire, scale, occasion].append(score)
    rows: list[Line] = []
    sources = []
    for name, questionnaire in QUESTIONNAIRES.items():
        for asked in questionnaire.scales:
            for key, scores in values.items():
                if key[:2] == (name, asked.name):
                    rows.append(_row(asked, key[2], scores))
        if any(key[0] == name for key in values):
            sources.append(f"{questionnaire.title}: {questionnaire.source}.")
    header: list[Line] = [
        ["Scale", Cell("when", kind="text"), "n", "mean ± SD", "median", "range", "better"]
    ]
    return section("Questionnaires", table(header, rows), paragraph(" ".join(sources)))


def _occasion(step: str, mode: str) -> str:
    if not mode:
        return "before all" if step.startswith("before-all") else "after all"
    when = "before" if "/before/" in step else "after"
    return f"{when} {mode_title(mode)}"


def _row(scale: Scale, when: str, scores: list[float]) -> Line:
    spread = f" ± {np.std(scores, ddof=1):.1f}" if len(scores) > 1 else ""
    return [
        scale.title,
        Cell(when, kind="text"),
        str(len(scores)),
        f"{np.mean(scores):.1f}{spread}",
        f"{np.median(scores):.1f}",
        f"{scale.lowest:g} to {scale.highest:g}",
        "more" if scale.better > 0 else "less",
    ]
