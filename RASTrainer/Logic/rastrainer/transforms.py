"""Units and homogeneous transforms: (4, 4) float arrays; `FromToTo` maps points of the first frame.

Lengths are in meters inside the simulator, and in millimeters on the wire, in Slicer and in files.
"""

from __future__ import annotations

import numpy as np

MM_PER_M = 1000.0


def apply(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Map points by a transform.

    Args:
        matrix: (4, 4) float, affine (last row 0 0 0 1).
        points: (..., 3) float.

    Returns:
        (..., 3) float, in the frame that the matrix maps to.
    """
    matrix = np.asarray(matrix, dtype=float)
    return np.asarray(points, dtype=float) @ matrix[:3, :3].T + matrix[:3, 3]


def rigid(rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    """Return the (4, 4) float transform of a (3, 3) rotation followed by a (3,) translation."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = translation
    return matrix


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse, (4, 4) float, of an affine transform.

    Raises:
        numpy.linalg.LinAlgError: the matrix is singular.
    """
    matrix = np.asarray(matrix, dtype=float)
    linear = np.linalg.inv(matrix[:3, :3])
    return rigid(linear, -linear @ matrix[:3, 3])


def is_rigid(matrix: np.ndarray) -> bool:
    """Return whether a (4, 4) float matrix is a rotation and a translation, to 1e-6."""
    rotation = matrix[:3, :3]
    is_orthonormal = np.allclose(rotation @ rotation.T, np.eye(3), rtol=0.0, atol=1e-6)
    return bool(
        is_orthonormal and np.linalg.det(rotation) > 0 and matrix[3].tolist() == [0, 0, 0, 1]
    )
