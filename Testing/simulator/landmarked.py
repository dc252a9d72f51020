"""A head with landmarks, and the path of a trace over its face, both RAS, mm."""

import itertools
import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np

from rastrainer.head.mesh import HeadMesh, nearest_on_mesh
from rastrainer.scenario.points import Landmark
from rastrainer_simulator.assets import asset_path

LANDMARKS = (
    Landmark("Nasion", np.array([0.95, 84.89, -36.69])),
    Landmark("Right outer canthus", np.array([52.53, 61.97, -42.14])),
    Landmark("Left outer canthus", np.array([-51.53, 61.83, -43.16])),
    Landmark("Right tragus", np.array([86.39, -8.19, -49.13])),
    Landmark("Left tragus", np.array([-87.49, -8.75, -48.18])),
)
OVER_THE_FACE = (
    ((-45, 80, 15), (45, 80, 15), (40, 75, 35), (-40, 75, 35)),
    ((0, 90, -10), (0, 88, -34), (0, 95, -52)),
    ((22, 82, -50), (50, 68, -50), (60, 55, -30)),
    ((-22, 82, -50), (-50, 68, -50), (-60, 55, -30)),
)
"""Corners of the strokes, near the skin: a zigzag over the forehead, the nose, and both cheeks."""


def with_landmarks(scenario):
    """Return a scenario with landmarks."""
    return replace(scenario, landmarks=LANDMARKS)


PLACES = [{"name": each.name, "positionRas": each.position_ras.tolist()} for each in LANDMARKS]


def write_landmarked(folder: Path, places: list[dict] = PLACES) -> Path:
    """Write the default scenario with landmarks at places into a new folder, and return it."""
    default = asset_path("scenarios", "colin27")
    folder.mkdir()
    shutil.copy(default / "head.ply", folder)
    shutil.copytree(default / "tasks", folder / "tasks")
    values = json.loads((default / "scenario.json").read_text())
    for left_out in ("volume", "procedures", "skull"):
        values.pop(left_out, None)
    values["landmarks"] = places
    (folder / "scenario.json").write_text(json.dumps(values, indent=2) + "\n")
    return folder


def on_skin(head: HeadMesh, corners, step_mm: float = 4.0) -> np.ndarray:
    """Return a stroke as places on the skin, (n, 3), about `step_mm` apart."""
    corners = np.array(corners, dtype=float)
    between = []
    for start, end in itertools.pairwise(corners):
        count = int(np.ceil(np.linalg.norm(end - start) / step_mm))
        between += [start + (end - start) * share for share in np.arange(count) / count]
    return np.array([nearest_on_mesh(head, place).position for place in (*between, corners[-1])])
