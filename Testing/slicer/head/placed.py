"""The phantom of a head in a scene, for tests: its volume, and fiducials on its skin."""

from __future__ import annotations

import numpy as np
import slicer
from slicer.util import vtkMatrixFromArray

from Testing.slicer.head.phantoms import SEMI_AXES

ROWS = ((5, 26.0), (10, 50.0))
"""Rings of fiducials: how many, and their angle from the crown."""


def add_volume(scene, volume, name):
    """Return a volume node of the scene with an image of `Volume`."""
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", name)
    slicer.util.updateVolumeFromArray(node, volume.values.transpose(2, 1, 0).copy())
    node.SetIJKToRASMatrix(vtkMatrixFromArray(volume.ijkToRas))
    return node


def fiducials(size=1.0):
    """Return fifteen positions on the phantom's skin, (15, 3) float, RAS mm, ring by ring.

    `phantom` explains `size`.
    """
    directions = []
    for count, polar_deg in ROWS:
        around = np.radians(np.linspace(0.0, 360.0, count, endpoint=False) - 90.0)
        polar = np.radians(polar_deg)
        ring = [np.cos(around) * np.sin(polar), np.sin(around) * np.sin(polar)]
        directions.append(np.stack([*ring, np.full(count, np.cos(polar))], axis=1))
    directions = np.concatenate(directions)
    return directions / np.linalg.norm(directions / (size * SEMI_AXES), axis=1, keepdims=True)


def add_transform(scene, shift):
    """Return a linear transform node of the scene that shifts by (3,), RAS mm."""
    matrix = np.eye(4)
    matrix[:3, 3] = shift
    node = scene.AddNewNodeByClass("vtkMRMLLinearTransformNode", "Moved")
    node.SetMatrixTransformToParent(vtkMatrixFromArray(matrix))
    return node
