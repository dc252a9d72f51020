"""Units and homogeneous transforms: (4, 4) float arrays; `FromToTo` maps points of the first frame.

Lengths are in meters inside the simulator, and in millimeters on the wire, in Slicer and in files.
"""

from __future__ import annotations

import numpy as np

MM_PER_M = 1000.0


def apply(matrix: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return points (..., 3) float mapped by an affine (4, 4) float matrix (last row 0 0 0 1)."""
    matrix = np.asarray(matrix, dtype=float)
    return np.asarray(points, dtype=float) @ matrix[:3, :3].T + matrix[:3, 3]


def apply_each(matrices: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return points (n, 3) mapped by each of the matrices (s, 4, 4), (s, n, 3) float."""
    return points @ np.swapaxes(matrices[:, :3, :3], 1, 2) + matrices[:, None, :3, 3]


def rigid(rotation: np.ndarray, translation: np.ndarray) -> np.ndarray:
    """Return the (4, 4) float transform of a (3, 3) rotation followed by a (3,) translation."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = translation
    return matrix


def in_meters(pose: np.ndarray) -> np.ndarray:
    """Return a pose (4, 4) float with its translation in m, of one in mm."""
    return rigid(pose[:3, :3], pose[:3, 3] / MM_PER_M)


def in_millimeters(pose: np.ndarray) -> np.ndarray:
    """Return a pose (4, 4) float with its translation in mm, of one in m."""
    return rigid(pose[:3, :3], MM_PER_M * pose[:3, 3])


def rotations(vectors: np.ndarray) -> np.ndarray:
    """Return the rotations (s, 3, 3) about vectors (s, 3) by their lengths in rad (Rodrigues)."""
    angles = np.linalg.norm(vectors, axis=1)
    cross = cross_products(vectors[:, None, :], np.eye(3))
    safe = np.where(angles > 1e-12, angles, 1.0)
    first = np.where(angles > 1e-12, np.sin(safe) / safe, 1.0)
    second = np.where(angles > 1e-12, (1.0 - np.cos(safe)) / safe**2, 0.5)
    # np.cross(v, e) has the columns of [v]× as its rows.
    cross = np.swapaxes(cross, 1, 2)
    return np.eye(3) + first[:, None, None] * cross + second[:, None, None] * cross @ cross


def inverse(matrix: np.ndarray) -> np.ndarray:
    """Return the inverse (4, 4) of an affine transform; raise LinAlgError if it is singular."""
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


def cross_products(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Return the cross products (…, 3), for few at a time faster than numpy's."""
    (a, b, c), (x, y, z) = np.moveaxis(one, -1, 0), np.moveaxis(other, -1, 0)
    return np.stack([b * z - c * y, c * x - a * z, a * y - b * x], axis=-1)


def frame_along(direction: np.ndarray) -> np.ndarray:
    """Return two unit vectors across a unit vector (3,), and that vector, as rows (3, 3)."""
    across = np.cross(direction, np.eye(3)[np.abs(direction).argmin()])
    across /= np.linalg.norm(across)
    return np.array([across, np.cross(direction, across), direction])
