"""A row of the bench's table, with what it is compared with if there is such a thing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def row(
    name: str, values: Sequence[float], unit: str, peer: str = "", others: Sequence[float] = ()
) -> dict:
    """Return the row of what was measured, with the keys of `__main__.COLUMNS`.

    `others` are the values of the `peer`; without one both are left out.
    """
    median, p99 = _median_and_p99(values)
    peer_median, peer_p99 = _median_and_p99(others) if peer else (None, None)
    return {
        "name": name,
        "median": median,
        "p99": p99,
        "unit": unit,
        "peer": peer or None,
        "peer_median": peer_median,
        "peer_p99": peer_p99,
        "success": None,
        "n": len(values),
    }


def _median_and_p99(values: Sequence[float]) -> tuple[float, float]:
    return float(np.median(values)), float(np.percentile(values, 99))
