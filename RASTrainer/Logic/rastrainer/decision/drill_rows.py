"""Drills as rows for progress, reports and tables; decided cases as a table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from enum import Enum

from rastrainer.decision.drill_record import DecidedCase, DrillRecord
from rastrainer.decision.drill_score import DRILL_SCORE_VERSION, drill_score
from rastrainer.trial.trial_row import TrialRow

_OWN = "score", "mean_cost", "brier", "mean_checks", "harmful", "vain"


def drill_rows(drills: Iterable[DrillRecord]) -> list[TrialRow]:
    """Return drills as trials are: numbered for each trainee, acceptable if passed."""
    counts: Counter[str] = Counter()
    rows = []
    for drill in drills:
        counts[drill.trainee] += 1
        score = drill_score(drill.cases)
        values = {
            "completion_time_s": sum(case.time_s for case in drill.cases),
            "sensitivity": score.sensitivity.value,
            "criterion": score.criterion.value,
            "ability_logits": score.ability.value,
            **{name: float(getattr(score, name)) for name in _OWN},
        }
        rows.append(
            TrialRow(
                *(drill.trainee, drill.mode, drill.task, counts[drill.trainee], values),
                *(drill.trial_id, drill.started_utc, drill.scenario, DRILL_SCORE_VERSION),
                acceptable=score.is_passed,
                completed_utc=drill.completed_utc,
                method="",
            )
        )
    return rows


COLUMNS = {
    "seed": ("From which the case was drawn.", ""),
    "fault": ("True cause of the error.", ""),
    "method": ("Method of registration.", ""),
    "limit_mm": ("Largest acceptable error at the target.", "mm"),
    "true_error_mm": ("True error at the target.", "mm"),
    "expected_error_mm": ("Expected error at the target, as shown.", "mm"),
    "residual_mm": ("Root mean square of the residuals, as shown.", "mm"),
    "difficulty": ("Of a Rasch model.", "logit"),
    "checks": ("Checked places, in order.", ""),
    "has_read_images": ("1 if the trainee read the images, else 0.", ""),
    "decision": ("To proceed, to register again or to stop.", ""),
    "confidence": ("Stated probability that the decision is right.", "%"),
    "suspected": ("Cause of the error that the trainee suspects.", ""),
    "is_right": ("1 for proceeding within the limit, or not beyond it; else 0.", ""),
    "time_s": ("Simulated time until the decision.", "s"),
}
"""Description and unit of each column, which is an attribute of a case."""


def cells(case: DecidedCase) -> list[object]:
    return [_cell(getattr(case, name)) for name in COLUMNS]


def _cell(value: object) -> object:
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, tuple):
        return "; ".join(value)
    return int(value) if isinstance(value, bool) else value
