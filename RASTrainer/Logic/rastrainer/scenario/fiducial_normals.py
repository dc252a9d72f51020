"""What follows from a head's mesh, computed once: above all, where outside is at the fiducials."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

import numpy as np

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.head.surface_queries import outward_normals
from rastrainer.scenario.scenario import Scenario

MOST_RESULTS = 64

Points = tuple[tuple[float, ...], ...]


def fiducial_normals(scenario: Scenario, task_name: str) -> np.ndarray:
    """Return the skin's outward unit normals at a task's fiducials, (n, 3) float, RAS; read only.

    Raises:
        InputError: there is no such task, or the head's mesh cannot be used.
    """
    fiducials = np.asarray(scenario.task(task_name).fiducials, dtype=float)
    return computed_once(scenario, _normals, tuple(map(tuple, fiducials.tolist())))


def computed_once(
    scenario: Scenario, compute: Callable[..., np.ndarray], *arguments: Points
) -> np.ndarray:
    """Return `compute(mesh, *arguments)` of the scenario's head; read only.

    The result is kept for as long as the mesh's file stays as it is.

    Raises:
        InputError: the head's mesh cannot be used.
    """
    mesh = scenario.head_mesh
    changed = mesh.stat().st_mtime_ns if mesh.is_file() else 0
    return _computed(mesh, changed, compute, arguments)


@lru_cache(maxsize=MOST_RESULTS)
def _computed(
    mesh: Path, _changed: int, compute: Callable[..., np.ndarray], arguments: tuple[Points, ...]
) -> np.ndarray:
    result = compute(read_head_mesh(mesh), *arguments)
    result.setflags(write=False)
    return result


def _normals(head: HeadMesh, fiducials: Points) -> np.ndarray:
    return outward_normals(head, np.array(fiducials))
