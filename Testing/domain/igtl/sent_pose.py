"""A pose as it is sent."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.igtl.content import Transform


def transform_of(matrix: np.ndarray | Sequence[Sequence[float]]) -> Transform:
    """Return the transform of a (4, 4) matrix in mm, whose last row is not sent."""
    return Transform(tuple(np.array(matrix, dtype=float)[:3].T.ravel().tolist()))
