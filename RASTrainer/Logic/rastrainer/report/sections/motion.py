"""The motion metrics: means by mode, and what each means."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.motion.definitions import DEFINITIONS
from rastrainer.number_text import fixed
from rastrainer.report.comparisons import ModeComparison
from rastrainer.report.markup import Cell, paragraph, section, table
from rastrainer.report.outcomes import MOTION_OUTCOMES, mode_title
from rastrainer.report.sections.paired_statistics import interval_text
from rastrainer.report.study_data import StudyData


def motion(data: StudyData, comparisons: Sequence[ModeComparison]) -> str:
    """Return the table; "" where no trial was recorded."""
    found = {name for trial in data.trials for name in trial.values}
    outcomes = [outcome for outcome in MOTION_OUTCOMES if outcome.name in found]
    if not outcomes:
        return ""
    effects = {c.outcome.name: c.result for c in comparisons if c.result is not None}
    rows = []
    for outcome in outcomes:
        cells: list[Cell | str] = [outcome.heading]
        for mode in data.modes:
            values = [
                t.values[outcome.name] for t in data.of_mode(mode) if outcome.name in t.values
            ]
            cells.append(_mean_and_sd(values, outcome.digits) if values else "–")
        effect = effects.get(outcome.name)
        cells.append(
            "–" if effect is None else interval_text(effect.hedges_gz, effect.gz_interval, 2)
        )
        rows.append(cells)
    definitions = [
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
        paragraph("Mean ± standard deviation of the trials; described, not tested."),
        table([["Metric", *modes, "g_z [95 %]"]], rows, "long"),
        table(
            [["Metric", Cell("Definition", kind="text"), Cell("Source", kind="text")]],
            definitions,
            "long",
        ),
    )


def _mean_and_sd(values: Sequence[float], digits: int) -> str:
    text = fixed(float(np.mean(values)), digits)
    if len(values) > 1:
        text += f" ± {fixed(float(np.std(values, ddof=1)), digits)}"
    return text
