"""The pose of the head in a trial: near its nominal pose, and known only to the simulator."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import default_rng

from rastrainer import transforms


@dataclass(frozen=True)
class Perturbation:
    """How far the head may be from its nominal pose.

    Attributes:
        translation_mm: along each axis of World.
        yaw_deg: about the vertical.
        tilt_deg: about a horizontal axis of any direction.
    """

    translation_mm: float
    yaw_deg: float
    tilt_deg: float


MAX_PERTURBATION = Perturbation(200.0, 180.0, 45.0)
"""Limits for scenarios and set-ups."""


def perturbed_pose(
    head_to_world: np.ndarray, pivot: np.ndarray, limits: Perturbation, seed: int
) -> np.ndarray:
    """Return the pose of the head for a seed, (4, 4) float, mm: rotated about a pivot, then moved.

    Args:
        head_to_world: (4, 4) float, the nominal pose.
        pivot: (3,) float, RAS mm.
        limits: of the perturbation.
        seed: 0 or above.
    """
    random = default_rng(seed)
    shift = random.uniform(-limits.translation_mm, limits.translation_mm, 3)
    yaw = np.radians(random.uniform(-limits.yaw_deg, limits.yaw_deg))
    toward, tilt = random.uniform([0.0, 0.0], [2.0 * np.pi, np.radians(limits.tilt_deg)])
    lean = _rotation(np.array([np.cos(toward), np.sin(toward), 0.0]), tilt)
    turn = lean @ _rotation(np.array([0.0, 0.0, 1.0]), yaw)
    center = transforms.apply(head_to_world, pivot)
    return transforms.rigid(turn, center + shift - turn @ center) @ head_to_world


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Return the rotation (3, 3) about a unit vector by an angle in rad (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross
