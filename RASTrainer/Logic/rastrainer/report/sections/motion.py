"""The motion metrics: means by mode, and what each means."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.motion.definitions import DEFINITIONS
from rastrainer.number_text import fixed
from rastrainer.report.html.markup import Cell, Line, paragraph, section, table
from rastrainer.report.results.comparisons import ModeComparison, tested
from rastrainer.report.sections.paired_statistics import interval_text
from rastrainer.statistics.paired import PairedComparison
from rastrainer.study.outcomes import MOTION_OUTCOMES, mode_title
from rastrainer.study.study_data import StudyData


def motion(data: StudyData, comparisons: Sequence[ModeComparison]) -> str:
    """Return the table; "" where no trial was recorded."""
    found = {name for trial in data.trials for name in trial.values}
    outcomes = [outcome for outcome in MOTION_OUTCOMES if outcome.name in found]
    if not outcomes:
        return ""
    compared = {c.outcome.name: result for c, result in tested(comparisons)}
    rows = []
    for outcome in outcomes:
        values = [
            [t.values[outcome.name] for t in data.of_mode(mode) if outcome.name in t.values]
            for mode in data.modes
        ]
        means = [_mean_and_sd(own, outcome.digits) if own else "–" for own in values]
        counts = " / ".join(str(len(own)) for own in values)
        rows.append([outcome.heading, *means, counts, *_effect(compared.get(outcome.name))])
    definitions: list[Line] = [
        [
            outcome.title,
            Cell(DEFINITIONS[outcome.name].definition, kind="text"),
            Cell(DEFINITIONS[outcome.name].source, kind="text"),
        ]
        for outcome in outcomes
    ]
    modes = [mode_title(mode) for mode in data.modes]
    return section(
        "Motion metrics",
        paragraph(
            "Mean ± standard deviation of the trials; described, not tested. g_z is of the n "
            "trainees who did both modes."
        ),
        table([["Metric", *modes, "trials", "n", "g_z [95 %]"]], rows),
        table(
            [["Metric", Cell("Definition", kind="text"), Cell("Source", kind="text")]], definitions
        ),
    )


def _effect(result: PairedComparison | None) -> list[str]:
    """Return the number of trainees and the effect size, as far as there is one."""
    if result is None:
        return ["–", "–"]
    if result.hedges_gz is None or result.gz_interval is None:
        return [str(result.n), "–"]
    return [str(result.n), interval_text(result.hedges_gz, result.gz_interval, 2)]


def _mean_and_sd(values: Sequence[float], digits: int) -> str:
    text = fixed(float(np.mean(values)), digits)
    if len(values) > 1:
        text += f" ± {fixed(float(np.std(values, ddof=1)), digits)}"
    return text
