"""A row of the bench's table, with what it is compared with if there is such a thing."""

from collections.abc import Sequence

import numpy as np

Figures = tuple[float, float]


def row(
    name: str,
    values: Sequence[float],
    unit: str,
    peer: str = "",
    others: Sequence[float] = (),
    *,
    success: float | None = None,
    n: int | None = None,
    worst: int = 99,
) -> dict:
    """Return the row of what was measured, with the keys of `__main__.COLUMNS`.

    `others` are the values of the `peer`; without them both its figures are left out. What is NaN
    was not measured. `worst` is the percentile at the bad end, 1 where more is better.
    """
    return row_of_figures(
        name,
        _figures(values, worst),
        unit,
        peer=peer,
        peer_figures=_figures(others, worst) if len(others) else None,
        success=success,
        n=len(values) if n is None else n,
    )


def row_of_figures(
    name: str,
    figures: Figures,
    unit: str,
    *,
    peer: str = "",
    peer_figures: Figures | None = None,
    success: float | None = None,
    n: int,
) -> dict:
    """Return the row of a median and a 99th percentile that are known already."""
    peer_median, peer_p99 = peer_figures or (None, None)
    return {
        "name": name,
        "median": float(figures[0]),
        "p99": float(figures[1]),
        "unit": unit,
        "peer": peer or None,
        "peer_median": peer_median,
        "peer_p99": peer_p99,
        "success": success,
        "n": n,
    }


def _figures(values: Sequence[float], worst: int) -> Figures:
    return float(np.nanmedian(values)), float(np.nanpercentile(values, worst))
