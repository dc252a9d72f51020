"""Input of a registration from the scene: pairs of points, and the skin's normals at them.

The user may change the pairs. Touches on the skin have different errors along and across it.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import compress
from typing import Any

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.files.point_list import pair
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, normal_at
from rastrainer.registration.localization_error import LocalizationError, error_along_surface
from rastrainer.registration.registration import Registration
from rastrainer.registration.warnings import RegistrationWarning, find_order, same_places
from rastrainer.slicer.scene.nodes import isUsed, labelsOf, surfaceOf, usedPoints, worldPoints
from rastrainer.slicer.translation import _

USUAL_FLE_MM = 1.0
"""Localization error of points without a stated one. Only ratios matter: the size of the errors is
estimated from the residuals."""


@dataclass(frozen=True)
class Choices:
    """The user's changes to the pairs, by label.

    `renamed` gives moving points other labels; `fle` is the localization error of points that do
    not have the usual one, RMS length in mm.
    """

    excluded: frozenset[str] = frozenset()
    renamed: Mapping[str, str] = field(default_factory=dict)
    fle: Mapping[str, float] = field(default_factory=dict)

    def without(self, labels: tuple[str, ...]) -> Choices:
        return replace(self, excluded=self.excluded | set(labels))

    def localized(self, label: str, fleMm: float) -> Choices:
        sizes = {**self.fle, label: fleMm}
        if fleMm == USUAL_FLE_MM:
            del sizes[label]
        return replace(self, fle=sizes)

    def weights(self, labels: Sequence[str]) -> np.ndarray | None:
        """Return the weight of each point, 1/FLE², (n,) float; None if all count alike."""
        fle = np.array([self.fle.get(label, USUAL_FLE_MM) for label in labels])
        return None if (fle == USUAL_FLE_MM).all() else 1.0 / fle**2

    def rename(self, order: dict[str, str]) -> Choices:
        """Return the choices with moving points given to other labels, on top of before."""
        shown = {**{label: label for label in order}, **self.renamed}
        renamed = {label: order.get(name, name) for label, name in shown.items()}
        return replace(self, renamed=renamed)


@dataclass(frozen=True)
class Pairs:
    """Paired points, (n, 3) float, mm: moving in the list's own frame and order, fixed in RAS.

    Fixed points are `missing` until they have a partner; pairs are `excluded` by choice, or because
    Slicer would not use a point.
    """

    labels: tuple[str, ...]
    moving: np.ndarray
    fixed: np.ndarray
    missing: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()


def readPairs(moving: Any, fixed: Any, choices: Choices) -> Pairs:
    """Return the pairs of two `vtkMRMLMarkupsNode`, by label where both lists are labeled.

    Fixed points that were not touched yet are allowed: a trial may be running.
    """
    for node, words in ((moving, _("moving")), (fixed, _("fixed"))):
        if node is None:
            raise InputError(_("Choose the list of {which} points.").format(which=words))
        if node.GetNumberOfControlPoints() == 0:
            raise InputError(_("The list of {which} points is empty.").format(which=words))
    movingLabels = tuple(choices.renamed.get(label, label) for label in labelsOf(moving))
    movingPoints = slicer.util.arrayFromMarkupsControlPoints(moving)
    movingList = usedPoints(moving, movingPoints, movingLabels)
    fixedList = usedPoints(fixed)
    leftOut = (*movingList.left_out_names, *fixedList.left_out_names)
    missing: tuple[str, ...] = ()
    if movingList.labels and fixedList.labels:
        touched = {*movingList.labels, *leftOut}
        missing = tuple(label for label in fixedList.labels if label not in touched)
        kept = [row for row, label in enumerate(fixedList.labels) if label in touched]
        if kept:
            fixedLabels = tuple(fixedList.labels[row] for row in kept)
            fixedList = replace(fixedList, labels=fixedLabels, points=fixedList.points[kept])
    labels, movingPoints, fixedPoints = pair(movingList, fixedList)
    rows = [row for row, label in enumerate(labels) if label not in choices.excluded]
    return Pairs(
        tuple(labels[row] for row in rows),
        movingPoints[rows],
        fixedPoints[rows],
        missing,
        tuple(dict.fromkeys((*leftOut, *(each for each in labels if each in choices.excluded)))),
    )


def snapshot(node: Any, pointsOf: Callable[[Any], np.ndarray] = worldPoints) -> tuple:
    """Return a value that changes with a list: its ID, labels, positions, and used points."""
    if node is None:
        return ()
    used = tuple(isUsed(node, row) for row in range(node.GetNumberOfControlPoints()))
    return node.GetID(), labelsOf(node), pointsOf(node).tobytes(), used


@dataclass(frozen=True)
class Remedy:
    """A warning with its button; the title is empty if only better points help."""

    warning: RegistrationWarning
    title: str
    choices: Choices


def remedyOf(warning: RegistrationWarning, registration: Registration, choices: Choices) -> Remedy:
    """Return a warning of a rigid registration with what one click can do about it."""
    order = None
    if warning.code == "order":
        order = find_order(registration.moving_mm, registration.fixed_mm)
    if order is not None:
        labels = registration.labels
        names = {labels[source]: labels[row] for row, source in enumerate(order)}
        changed = {old: new for old, new in names.items() if old != new}
        return Remedy(warning, _("Put in order"), choices.rename(changed))
    if warning.code not in ("outlier", "duplicate"):
        return Remedy(warning, "", choices)
    leftOut = warning.points
    if warning.code == "duplicate":
        # The first may stay: one point at a place is no duplicate.
        same = same_places(registration.moving_mm) | same_places(registration.fixed_mm)
        rows = [registration.labels.index(label) for label in leftOut]
        later = np.tril(same[np.ix_(rows, rows)]).any(axis=1)
        leftOut = tuple(compress(leftOut, later))
    title = _("Leave out {labels}").format(labels=", ".join(leftOut))
    return Remedy(warning, title, choices.without(leftOut))


SAME_HEAD_MM = 3.0
"""Fiducials farther from the surface do not lie on this head."""


class SkinNormals:
    """A head's surface and its normals at points, each found once; for one thread at a time."""

    def __init__(self, mesh: HeadMesh | None) -> None:
        """`mesh` is None if the surface has other cells than triangles."""
        self._mesh = mesh
        self._known: dict[bytes, np.ndarray | None] = {}

    def knows(self, points: np.ndarray) -> bool:
        """Return whether `findNormals` has had all points (n, 3)."""
        return all(point.tobytes() in self._known for point in points)

    def findNormals(self, points: np.ndarray) -> None:
        """Find the normals at points (n, 3), RAS mm; the first on a head takes seconds."""
        for point in points:
            if point.tobytes() in self._known:
                continue
            normal = None
            if self._mesh is not None:
                nearest = nearest_on_mesh(self._mesh, point)
                if nearest.distance <= SAME_HEAD_MM:
                    normal = normal_at(self._mesh, nearest)
            self._known[point.tobytes()] = normal

    def localizationError(self, registration: Registration) -> LocalizationError | None:
        """Return the localization error of touches on the skin, separately along and across it.

        None if a fixed point is off the surface, or there are too few.
        """
        self.findNormals(registration.fixed_mm)
        normals = [self._known[point.tobytes()] for point in registration.fixed_mm]
        if not any(normal is None for normal in normals):
            with contextlib.suppress(InputError):
                return error_along_surface(registration, np.array(normals))
        return None


def readSkin(model: Any | None) -> SkinNormals | None:
    """Return the skin of a `vtkMRMLModelNode`; None if it has no surface yet."""
    from vtk.util.numpy_support import vtk_to_numpy

    if model is None or not surfaceOf(model):
        return None
    mesh, cells = None, model.GetPolyData().GetPolys()
    if cells.GetNumberOfCells() and cells.IsHomogeneous() == 3:
        triangles = vtk_to_numpy(cells.GetConnectivityArray()).reshape(-1, 3).copy()
        mesh = HeadMesh(slicer.util.arrayFromModelPoints(model).astype(float), triangles)
    return SkinNormals(mesh)
