"""A picture of what the removal of a face takes away, for people to judge."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer

from rastrainer.head.mesh import HeadMesh
from rastrainer.head.volume import HeadVolume
from rastrainer.scenario.scenario import Camera
from rastrainer_simulator.rendering.picture import frames, write_png
from rastrainer_simulator.scene.surfaces import surface

VIEWS = np.array([[0.3, 1.0, 0.1], [1.0, 0.0, 0.0], [0.0, -1.0, 0.1]])
"""Where the eye is: in front, at the right and behind, as A and R of RAS say."""

SIDE = 300
"""Pixels along each side of a view."""

_DISTANCE, _ANGLE_DEG = 5.2, 26.0
_SKIN, _AROUND = (0.85, 0.66, 0.55), (1.0, 1.0, 1.0)


def draw_removal(
    path: Path,
    heads: tuple[HeadMesh, HeadMesh],
    volumes: tuple[HeadVolume, HeadVolume] | None,
) -> None:
    """Draw a head from three sides, and its images in the middle: before above, after below."""
    rows = []
    for index, head in enumerate(heads):
        parts = _views(head, heads[0])
        if volumes is not None:
            parts.append(_middle(volumes[index], heads[0]))
        rows.append(np.concatenate(parts, axis=1))
    write_png(np.concatenate(rows), path)


def _views(head: HeadMesh, before: HeadMesh) -> list[np.ndarray]:
    """Return a head as seen from three sides, (SIDE, SIDE, 3) uint8, from where `before` fits."""
    mapper, actor, renderer = vtkPolyDataMapper(), vtkActor(), vtkRenderer()
    # A renderer's camera is in meters.
    mapper.SetInputData(surface(head.vertices / 1000.0, head.triangles, head.vertex_normals))
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(*_SKIN)
    renderer.AddActor(actor)
    renderer.SetBackground(*_AROUND)
    reach = _DISTANCE * float(before.size.max()) / 2.0
    up = np.array([0.0, 0.0, 1.0])
    cameras = (
        Camera(before.middle + reach * view / np.linalg.norm(view), before.middle, up, _ANGLE_DEG)
        for view in VIEWS
    )
    return list(frames(renderer, ((camera, (SIDE, SIDE)) for camera in cameras)))


def _middle(volume: HeadVolume, head: HeadMesh) -> np.ndarray:
    """Return the sagittal plane through a head's middle as gray (SIDE, SIDE, 3) uint8, A left."""
    along = (np.arange(SIDE) + 0.5) / SIDE - 0.5
    heights, depths = np.meshgrid(along, along, indexing="ij")
    places = head.middle + float(head.size.max()) * 1.1 * np.stack(
        [np.zeros_like(depths), -depths, -heights], axis=-1
    )
    to_ijk = np.linalg.inv(volume.ijk_to_ras)
    voxels = np.rint(places @ to_ijk[:3, :3].T + to_ijk[:3, 3]).astype(int)
    is_within = ((voxels >= 0) & (voxels < volume.values.shape)).all(axis=-1)
    values = np.full((SIDE, SIDE), float(volume.values.min()))
    values[is_within] = volume.values[tuple(voxels[is_within].T)]
    share = np.clip((values - volume.level) / volume.window + 0.5, 0.0, 1.0)
    return np.repeat((255 * share).astype(np.uint8)[:, :, None], 3, axis=2)
