"""Normals of the head's surface at fiducials: touches err otherwise along the skin than across."""

from __future__ import annotations

from typing import Any

import numpy as np
import slicer
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.head_mesh import HeadMesh
from rastrainer.localization_error import LocalizationError, error_along_surface
from rastrainer.registration import Registration
from rastrainer.surface_queries import nearest_on_mesh, normal_at

SAME_HEAD_MM = 3.0
"""Fiducials farther from the surface do not lie on this head."""


class SkinNormals:
    """Finds normals on a head model of the scene, each point of it once."""

    def __init__(self) -> None:
        self._surface: tuple = ()
        self._mesh: HeadMesh | None = None
        self._known: dict[bytes, np.ndarray | None] = {}

    def errorOnSkin(
        self, model: Any | None, registration: Registration
    ) -> LocalizationError | None:
        """Return the localization error of touches on the skin, told apart along and across it.

        None where the fixed points do not all lie on the surface of the model, or are too few:
        then nothing is known but an error that is alike in all directions.
        """
        if model is None or model.GetPolyData() is None:
            return None
        self._read(model)
        normals = [self._normal(point) for point in registration.fixed_mm]
        if any(normal is None for normal in normals):
            return None
        try:
            return error_along_surface(registration, np.array(normals))
        except InputError:
            return None

    def _read(self, model: Any) -> None:
        data = model.GetPolyData()
        surface = (model.GetID(), data.GetPoints() and data.GetPoints().GetMTime())
        if surface == self._surface:
            return
        self._surface, self._known, self._mesh = surface, {}, None
        if data.GetNumberOfPolys() and data.GetPolys().IsHomogeneous() == 3:
            vertices = slicer.util.arrayFromModelPoints(model).astype(float)
            triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            self._mesh = HeadMesh(vertices, triangles)

    def _normal(self, point: np.ndarray) -> np.ndarray | None:
        key = point.tobytes()
        if key not in self._known:
            self._known[key] = self._mesh and _normalOn(self._mesh, point)
        return self._known[key]


def _normalOn(mesh: HeadMesh, point: np.ndarray) -> np.ndarray | None:
    nearest = nearest_on_mesh(mesh, point)
    return normal_at(mesh, nearest) if nearest.distance <= SAME_HEAD_MM else None
