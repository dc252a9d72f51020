"""The region of a head that a registration has to be right in, and its true error there.

Neither fiducials nor one target show how far a guided instrument would miss: a registration may be
right at a lucky point and wrong beside it. So the true error is taken over the scenario's targets
and over a grid of the brain's volume, half and half.

The brain is not segmented. The grid stands for it: the points of a 10 mm grid that lie at least
15 mm under the skin (scalp, skull and cerebrospinal fluid) and at most 120 mm below the vertex.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.surface_queries import nearest_vertices
from rastrainer.registration.localization_error import motions
from rastrainer.registration.registration import RIGID
from rastrainer.registration.target_error import true_errors
from rastrainer.scenario.fiducial_normals import computed_once
from rastrainer.scenario.scenario import Scenario

SPACING_MM = 10.0
UNDER_SKIN_MM = 15.0
BELOW_VERTEX_MM = 120.0


@dataclass(frozen=True, eq=False)
class Region:
    """Where a registration has to be right.

    Attributes:
        targets: (m, 3) float, RAS mm, at least one.
        grid: (n, 3) float, RAS mm, of the brain's volume.
    """

    targets: np.ndarray
    grid: np.ndarray

    def mean(self, of_targets: np.ndarray, of_grid: np.ndarray) -> float:
        """Return the mean of a value at the targets and at the grid, each half of it."""
        return float((np.mean(of_targets) + np.mean(of_grid)) / 2)

    def tre_mm(self, world_to_head: np.ndarray, head_to_world: np.ndarray) -> float:
        """Return the RMS true TRE of a registration.

        Args:
            world_to_head: (4, 4) float, mm, the registration.
            head_to_world: (4, 4) float, mm, where the head really is.
        """
        squares = [
            np.sum(true_errors(world_to_head, head_to_world, points) ** 2, axis=1)
            for points in (self.targets, self.grid)
        ]
        return float(np.sqrt(self.mean(*squares)))

    def tre_per_fle(self, fiducials: np.ndarray, normals: np.ndarray) -> float:
        """Return the RMS TRE to expect of a rigid registration of touches on the skin.

        Their errors are independent, of an FLE of 1 mm each, and lie along the skin, in which all
        directions are alike: Cov(eᵢ) = ½ (I − nᵢnᵢᵀ). To first order they move the fit by
        Σ (Σ JᵀJ)⁻¹ Jᵢᵀ eᵢ, and a point r by J(r) times that, with J the motions of a point.

        Args:
            fiducials: (n, 3) float, RAS mm, not on one line.
            normals: (n, 3) float, unit normals of the skin there, RAS.
        """
        center = fiducials.mean(axis=0)
        moved = motions(RIGID, fiducials - center)
        fit = np.linalg.pinv(moved.reshape(-1, moved.shape[2])).reshape(-1, *fiducials.shape)
        along = (np.eye(3) - normals[:, :, None] * normals[:, None, :]) / 2
        covariance = np.einsum("anj,njk,bnk->ab", fit, along, fit)
        squares = []
        for points in (self.targets, self.grid):
            moves = motions(RIGID, points - center)
            squares.append(np.einsum("nia,ab,nib->n", moves, covariance, moves))
        return float(np.sqrt(self.mean(*squares)))


def region_of(scenario: Scenario) -> Region:
    """Return the region of a scenario: the head's target, the planned ones, and the grid.

    Raises:
        InputError: the head's mesh cannot be used.
    """
    targets = [scenario.target_position, *(target.position for target in scenario.targets)]
    return Region(np.array(targets, dtype=float), computed_once(scenario, brain_grid))


def brain_grid(head: HeadMesh) -> np.ndarray:
    """Return the grid's points, (n, 3) float, RAS mm.

    Raises:
        InputError: the head is too small or too flat to have any.
    """
    top = head.vertices[:, 2].max()
    low, high = head.vertices.min(axis=0), head.vertices.max(axis=0)
    low[2] = max(low[2], top - BELOW_VERTEX_MM)
    axes = [
        SPACING_MM * np.arange(np.ceil(a / SPACING_MM), np.floor(b / SPACING_MM) + 1)
        for a, b in zip(low, high, strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    distances, nearest = nearest_vertices(head, grid)
    inward = head.vertices[nearest] - grid
    is_inside = np.einsum("ij,ij->i", inward, head.vertex_normals[nearest]) > 0
    inside = grid[is_inside & (distances >= UNDER_SKIN_MM)]
    if not len(inside):
        raise InputError(
            f"No part of the head lies {UNDER_SKIN_MM:g} mm under its skin: there is no brain in "
            "which the true error could be computed."
        )
    return inside
