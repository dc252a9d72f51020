"""Normals of the head's surface at fiducials: touch errors differ along and across the skin."""

from __future__ import annotations

from typing import Any

import numpy as np
import slicer
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, normal_at
from rastrainer.registration.localization_error import LocalizationError, error_along_surface
from rastrainer.registration.registration import Registration
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.signal import Signal

SAME_HEAD_MM = 3.0
"""Fiducials farther from the surface do not lie on this head."""


class SkinNormals:
    """Finds and remembers normals on a head model of the scene.

    Attributes:
        found: emits nothing when a search in the background has found normals.
    """

    def __init__(self, work: BackgroundWork | None = None) -> None:
        """`work` looks for the normals on a head that is new; at once if omitted."""
        self.found = Signal()
        self._work = work
        self._surface: tuple = ()
        self._mesh: HeadMesh | None = None
        self._known: dict[bytes, np.ndarray | None] = {}
        self._isLooking = False

    def errorOnSkin(
        self, model: Any | None, registration: Registration, expected: np.ndarray | None = None
    ) -> LocalizationError | None:
        """Return the localization error of touches on the skin, separately along and across it.

        None where the fixed points do not all lie on the surface of the model, or are too few:
        then nothing is known but an error that is alike in all directions. None, too, until the
        normals on a new head are found.

        Args:
            model: a `vtkMRMLModelNode`, or None.
            registration: whose fixed points are touched.
            expected: (n, 3) float, RAS mm, points that will be; they are looked for as well.
        """
        if model is None or model.GetPolyData() is None:
            return None
        self._read(model)
        missing = [point for point in registration.fixed_mm if point.tobytes() not in self._known]
        if missing:
            points = missing if expected is None else [*missing, *expected]
            if not self._look(points):
                return None
        normals = [self._known[point.tobytes()] for point in registration.fixed_mm]
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
        self._isLooking = False
        if data.GetNumberOfPolys() and data.GetPolys().IsHomogeneous() == 3:
            vertices = slicer.util.arrayFromModelPoints(model).astype(float)
            triangles = vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3)
            self._mesh = HeadMesh(vertices, triangles.copy())

    def _look(self, points: list[np.ndarray]) -> bool:
        """Look for the normals at points, and return whether they are known at once."""
        mesh, surface = self._mesh, self._surface
        # The first search on a head takes some seconds, a further point a moment.
        if self._work is None or self._known or mesh is None:
            self._known |= _normalsOn(mesh, points)
            return True

        def take(normals: dict[bytes, np.ndarray | None]) -> None:
            if surface == self._surface:
                self._known |= normals
                self._isLooking = False
                self.found.emit()

        if not self._isLooking:
            self._isLooking = True
            self._work.do(lambda: _normalsOn(mesh, points), take)
        return False


def _normalsOn(mesh: HeadMesh | None, points: list[np.ndarray]) -> dict[bytes, np.ndarray | None]:
    """Return the normal at each point; None at one that does not lie on the mesh."""
    return {point.tobytes(): None if mesh is None else _normalOn(mesh, point) for point in points}


def _normalOn(mesh: HeadMesh, point: np.ndarray) -> np.ndarray | None:
    nearest = nearest_on_mesh(mesh, point)
    return normal_at(mesh, nearest) if nearest.distance <= SAME_HEAD_MM else None
