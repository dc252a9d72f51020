"""The region in which a registration has to be right, and the reference values of a task's score.

Neither fiducials nor one target show how far a guided instrument would miss: a registration may be
right at one point by chance and wrong next to it. So the true error is taken over the scenario's
targets and over a grid of the brain's volume, half and half. The brain is not segmented: the grid
is made of the points of a 10 mm grid that lie at least 15 mm under the skin (scalp, skull and
cerebrospinal fluid) and at most 120 mm below the vertex.

Equal skill should get equal scores on every task of every head. So the reference time follows from
the tip's path through the fiducials, and the reference error from how touching errors propagate to
the region. A touch is on the skin, so its errors lie along the skin; isotropic errors (Fitzpatrick,
West and Maurer 1998) would allow tasks on a small patch up to twice the error that the same skill
causes. Testing/error_rates/tables.md compares the scores on three heads.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, nearest_vertices, outward_normals, read_head_mesh
from rastrainer.protocol import FIDUCIAL_COUNT, TRACED_METHODS, RegistrationMethod
from rastrainer.registration.fits import RIGID, motions
from rastrainer.registration.target_error import true_errors
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario, task_by_method
from rastrainer.trial.scoring import ScoreReference

MAX_RESULTS = 64

Points = tuple[tuple[float, ...], ...]


def fiducial_normals(scenario: Scenario, task_name: str) -> np.ndarray:
    """Return the outward unit normals of the skin at a task's fiducials, (n, 3) float, RAS."""
    return point_normals(scenario, scenario.task(task_name))


def point_normals(scenario: Scenario, task: Task) -> np.ndarray:
    """Return the skin's outward unit normals at a task's points, (n, 3) float, RAS; read-only."""
    points = np.asarray(task.fiducials, dtype=float)
    return computed_once(scenario, outward_normals, tuple(map(tuple, points.tolist())))


def computed_once(
    scenario: Scenario, compute: Callable[..., np.ndarray], *arguments: Points
) -> np.ndarray:
    """Return the cached, read-only `compute(mesh, *arguments)` for the scenario's head.

    The cache is valid while the mesh's file is unchanged.
    """
    return _computed(*_head_file(scenario), compute, arguments)


def head_of(scenario: Scenario) -> HeadMesh:
    """Return the scenario's head, which is read once while its file is unchanged."""
    return _read_head(*_head_file(scenario))


def _head_file(scenario: Scenario) -> tuple[Path, int]:
    path = scenario.head
    return path, path.stat().st_mtime_ns if path.is_file() else 0


@lru_cache(maxsize=1)
def _read_head(path: Path, _changed: int) -> HeadMesh:
    return read_head_mesh(path)


@lru_cache(maxsize=MAX_RESULTS)
def _computed(
    path: Path, changed: int, compute: Callable[..., np.ndarray], arguments: tuple[Points, ...]
) -> np.ndarray:
    result = compute(_read_head(path, changed), *arguments)
    result.setflags(write=False)
    return result


SPACING_MM = 10.0
UNDER_SKIN_MM = 15.0
BELOW_VERTEX_MM = 120.0


@dataclass(frozen=True, eq=False)
class Region:
    """Targets (m, 3) and brain grid (n, 3), RAS mm, where a registration has to be right."""

    targets: np.ndarray
    grid: np.ndarray

    def mean(self, of_targets: np.ndarray, of_grid: np.ndarray) -> float:
        """Return the mean of a value over targets and grid, weighted half and half."""
        return float((np.mean(of_targets) + np.mean(of_grid)) / 2)

    def tre_mm(self, world_to_head: np.ndarray, head_to_world: np.ndarray) -> float:
        """Return the RMS true TRE of a registration; matrices as in `true_errors`."""
        squares = [
            np.sum(true_errors(world_to_head, head_to_world, points) ** 2, axis=1)
            for points in (self.targets, self.grid)
        ]
        return float(np.sqrt(self.mean(*squares)))

    def tre_per_fle(self, fiducials: np.ndarray, normals: np.ndarray) -> float:
        """Return the expected RMS TRE of a rigid registration of touches on the skin.

        The touching errors are independent, with an FLE of 1 mm, and isotropic along the skin:
        Cov(eᵢ) = ½ (I − nᵢnᵢᵀ). They move the fit by Σ (Σ JᵀJ)⁻¹ Jᵢᵀ eᵢ, and a point r by J(r)
        times that, to first order, with J the motions of a point. The fiducials (n, 3), RAS mm, are
        not collinear, and the unit normals (n, 3) of the skin there are in RAS.
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
    targets = [scenario.target.position_ras, *(target.position_ras for target in scenario.targets)]
    return Region(np.array(targets, dtype=float), computed_once(scenario, brain_grid))


def brain_grid(head: HeadMesh) -> np.ndarray:
    """Return the points of the grid, (n, 3) float, RAS mm."""
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


LIFT_MM = 35.0
"""Height of the tip above the skin between two fiducials."""
TOUCH_S, SPEED_MM_S = 5.2, 26.0
"""Time per fiducial, and speed of the tip between two. The ratio comes from the virtual trainee on
the six tasks of Colin27; the scale gives Tasks 1 to 5 the mean of 127 s of the published study,
pooled over both modes."""
PUBLISHED_RMSE_MM = 1.4
"""The published study's mean RMSE over fifteen fiducials."""
REFERENCE_FLE_MM = PUBLISHED_RMSE_MM / np.sqrt(1 - 2 / FIDUCIAL_COUNT)
"""The FLE that explains it: E[FRE²] = (1 − 2/N) E[FLE²]."""


REFERENCE_TRACE_MM, TRACE_SPEED_MM_S = 200.0, 15.0
"""Length of the path over the skin that a trace should take, and its speed: our own convention."""


def score_reference(
    scenario: Scenario,
    task_name: str,
    of_protocol: Mapping[str, ScoreReference] | None = None,
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS,
) -> ScoreReference:
    """Return the reference of a task.

    Every method's error is compared with the error by the task's fiducials: the needs of an
    operation do not depend on how its head was registered. The reference time includes the points
    that the method has touched, and a trace of `REFERENCE_TRACE_MM`. References of a
    protocol, by task, take precedence for fiducials.
    """
    is_by_fiducials = method is RegistrationMethod.FIDUCIALS
    if of_protocol and task_name in of_protocol and is_by_fiducials:
        return of_protocol[task_name]
    fiducials = np.asarray(scenario.task(task_name).fiducials, dtype=float)
    normals = fiducial_normals(scenario, task_name)
    touched = task_by_method(scenario, task_name, method)
    trace_mm = REFERENCE_TRACE_MM if method in TRACED_METHODS else 0.0
    # The tip moves straight between points above the fiducials; where the skin and the tool turn
    # between two, the path is longer.
    above = touched.fiducials + LIFT_MM * point_normals(scenario, touched)
    path_mm = np.linalg.norm(np.diff(above, axis=0), axis=1).sum()
    touching_s = float(TOUCH_S * len(above) + path_mm / SPEED_MM_S)
    return ScoreReference(
        time_s=touching_s + trace_mm / TRACE_SPEED_MM_S,
        tre_mm=float(REFERENCE_FLE_MM * region_of(scenario).tre_per_fle(fiducials, normals)),
    )
