"""What a shift of the skin did: true errors beside those that the same trials had without it."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.number_text import fixed
from rastrainer.report.elements.markup import Line, paragraph, section, table
from rastrainer.report.sections.method_comparison import TITLES
from rastrainer.study.study_data import StudyData, TrialRow

INTRO = (
    "In these trials the skin lay otherwise than in the images. Residual and expected error show "
    "little of it. The last column is of the same points, put back to where they would have been "
    "measured and registered again; means over the trials whose truth was revealed."
)
HEADER = (
    *("Shift, RMS (mm)", "indentation (mm)", "registered by", "trials", "residual (mm)"),
    *("expected TRE (mm)", "true TRE (mm)", "without the shift (mm)"),
)


def shifted_skin(data: StudyData) -> str:
    """Return the section; "" where the skin lay as in the images in all trials."""
    groups: dict[tuple[float, float, str], list[TrialRow]] = {}
    for trial in data.trials:
        if "skin_shift_mm" in trial.values:
            amounts = trial.values["skin_shift_mm"], trial.values["skin_indentation_mm"]
            groups.setdefault((*amounts, trial.method), []).append(trial)
    if not groups:
        return ""
    rows = [_row(*key, groups[key]) for key in sorted(groups)]
    return section("Shifted skin", paragraph(INTRO), table([HEADER], rows, "wide"))


def _row(shift: float, indentation: float, method: str, trials: Sequence[TrialRow]) -> Line:
    names = ("rmse_mm", "expected_tre_mm", "true_tre_mm", "unshifted_tre_mm")
    means = [_mean(trials, name) for name in names]
    by = TITLES.get(method, method)
    return [fixed(shift, 1), fixed(indentation, 1), by, str(len(trials)), *means]


def _mean(trials: Sequence[TrialRow], name: str) -> str:
    values = [trial.values[name] for trial in trials if name in trial.values]
    return fixed(float(np.mean(values)), 2) if values else "–"
