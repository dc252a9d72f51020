"""Heads of which everything is known: an egg with nose, skull and neck, as MRI or CT."""

import numpy as np
from scipy.spatial.transform import Rotation

from rastrainer.slicer.head.volume import Volume

SEMI_AXES = np.array([62.0, 76.0, 70.0])
NOSE = np.array([0.0, 74.0, -22.0])
SCALP_MM, SKULL_MM = 6.0, 6.0
MRI = {"scalp": 100.0, "bone": 10.0, "brain": 75.0, "air": 0.0}
CT = {"scalp": 40.0, "bone": 1100.0, "brain": 30.0, "air": -1000.0}
DOUBLE_OBLIQUE = Rotation.from_euler("xyz", [12.0, -8.0, 15.0], degrees=True).as_matrix()
SAGITTAL = np.array([[0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
"""Rows of a slice run to the back, its columns down, and slices from the left to the right."""


def depth_mm(ras, size=1.0):
    """Return how deep positions (n, 3) are below the skin, mm, roughly; negative outside.

    `size` scales the head: 0.5 makes it half as wide, long and high as usual.
    """
    ras = ras / size
    radius = np.linalg.norm(ras / SEMI_AXES, axis=1)
    gradient = np.linalg.norm(ras / SEMI_AXES**2, axis=1) / np.maximum(radius, 1e-9)
    egg = (1.0 - radius) / np.maximum(gradient, 1e-9)
    neck = 45.0 - np.hypot(ras[:, 0], ras[:, 1] + 10.0)
    neck = np.where(ras[:, 2] < 0, neck, -50.0)
    nose = 12.0 - np.linalg.norm(ras - NOSE, axis=1)
    return size * np.maximum(np.maximum(egg, neck), nose)


def voxel_depths(values, to_ras, size):
    """Return how deep below the skin each voxel of an image is, (i, j, k), mm."""
    ijk = np.indices(values.shape).reshape(3, -1).T
    return depth_mm(ijk @ to_ras[:3, :3].T + to_ras[:3, 3], size).reshape(values.shape)


def phantom(
    values=MRI,
    spacing=(1.0, 1.0, 1.0),
    lowest=-62.0,
    turn_deg=0.0,
    noise=0.0,
    axes=None,
    shape=None,
    size=1.0,
):
    """Return a head as a volume with partial volume at the skin.

    It is turned in the scanner about S, or stored along `axes`, the columns of (3, 3). It has
    as many voxels as the head needs, or `shape`. A head of half the `size`, with half
    the air around it, takes a fifth of the time to be found; scalp and skull are as thick as ever.
    """
    spacing = np.array(spacing, dtype=float)
    low, high = size * np.array([-78.0, -92.0, lowest]), size * np.array([78.0, 98.0, 82.0])
    c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    extent = high - low if axes is None else np.abs(axes).T @ (high - low)
    axes = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) if axes is None else axes
    shape = np.ceil(extent / spacing).astype(int) if shape is None else np.array(shape)
    matrix = np.eye(4)
    matrix[:3, :3] = axes @ np.diag(spacing)
    middle = (low + high) / 2.0
    matrix[:3, 3] = middle - matrix[:3, :3] @ ((shape - 1) / 2.0)
    ijk = np.indices(shape).reshape(3, -1).T
    ras = ijk @ matrix[:3, :3].T + matrix[:3, 3]
    depth = depth_mm(ras, size)
    share = np.clip(depth + 0.5, 0.0, 1.0)
    kind = np.full(len(depth), values["scalp"])
    kind[depth > SCALP_MM] = values["bone"]
    kind[depth > SCALP_MM + SKULL_MM] = values["brain"]
    image = values["air"] + share * (kind - values["air"])
    if noise:
        image += np.random.default_rng(3).normal(0.0, noise, len(image))
    return Volume(image.reshape(shape).astype(np.float32), matrix)
