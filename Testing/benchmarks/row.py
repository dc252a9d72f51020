"""A row of the bench's table that is compared with nothing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np


def row(name: str, values: Sequence[float], unit: str) -> dict:
    """Return the row of what was measured, with the keys of `__main__.COLUMNS`."""
    return {
        "name": name,
        "median": float(np.median(values)),
        "p99": float(np.percentile(values, 99)),
        "unit": unit,
        "peer": None,
        "peer_median": None,
        "peer_p99": None,
        "success": None,
        "n": len(values),
    }
