"""Where outside is at the fiducials of a task."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from rastrainer.head_mesh import read_head_mesh
from rastrainer.scenario import Scenario
from rastrainer.surface_queries import outward_normals

MOST_TASKS = 64


def fiducial_normals(scenario: Scenario, task_name: str) -> np.ndarray:
    """Return the skin's outward unit normals at a task's fiducials, (n, 3) float, RAS; read only.

    Raises:
        InputError: there is no such task, or the head's mesh cannot be used.
    """
    mesh, fiducials = scenario.head_mesh, scenario.task(task_name).fiducials
    changed = mesh.stat().st_mtime_ns if mesh.is_file() else 0
    return _normals(mesh, changed, np.asarray(fiducials, dtype=float).tobytes())


@lru_cache(maxsize=MOST_TASKS)
def _normals(mesh: Path, _changed: int, fiducials: bytes) -> np.ndarray:
    points = np.frombuffer(fiducials).reshape(-1, 3)
    normals = outward_normals(read_head_mesh(mesh), points)
    normals.setflags(write=False)
    return normals
