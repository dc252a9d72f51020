"""Damped least squares for a handful of equations: at this size faster than numpy's calls."""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

Row = Sequence[float]


def damped_step(rows: Sequence[Row], wanted: Sequence[float], damping: float) -> list[float]:
    """Return Jᵀ (J Jᵀ + damping · I)⁻¹ wanted for a Jacobian of n rows of seven.

    J Jᵀ is factored by Cholesky; each pivot is kept as its inverse.
    """
    factor: list[list[float]] = []
    solved: list[float] = []
    for i, row in enumerate(rows):
        line: list[float] = []
        diagonal, right = _dot(row, row) + damping, wanted[i]
        for j in range(i):
            value, above = _dot(row, rows[j]), factor[j]
            for k in range(j):
                value -= line[k] * above[k]
            value *= above[j]
            line.append(value)
            diagonal -= value * value
            right -= value * solved[j]
        pivot = 1.0 / sqrt(diagonal)
        line.append(pivot)
        factor.append(line)
        solved.append(right * pivot)
    step = [0.0] * 7
    for i in range(len(rows) - 1, -1, -1):
        line = factor[i]
        weight = solved[i] * line[i]
        for k in range(i):
            solved[k] -= line[k] * weight
        step = [a + weight * b for a, b in zip(step, rows[i], strict=True)]
    return step


def _dot(a: Row, b: Row) -> float:
    return (
        a[0] * b[0]
        + a[1] * b[1]
        + a[2] * b[2]
        + a[3] * b[3]
        + a[4] * b[4]
        + a[5] * b[5]
        + a[6] * b[6]
    )
