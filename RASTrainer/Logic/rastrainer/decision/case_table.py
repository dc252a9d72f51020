"""The decided cases as a table: its columns with their descriptions and units, and its rows."""

from __future__ import annotations

from enum import Enum

from rastrainer.decision.drill_record import DecidedCase

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
