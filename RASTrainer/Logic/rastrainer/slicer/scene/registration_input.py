"""What a registration takes from the scene: pairs of points, and the normals of the skin at them.

The user may change the pairs. Of touches on the skin, errors differ along and across it.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import slicer
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.head.mesh import HeadMesh, nearest_on_mesh, normal_at
from rastrainer.registration.fits import extents
from rastrainer.registration.localization_error import LocalizationError, error_along_surface
from rastrainer.registration.registration import Registration
from rastrainer.registration.warnings import SAME_PLACE, RegistrationWarning, find_order
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.nodes import labelsOf, localPoints, worldPoints
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

USUAL_FLE_MM = 1.0
"""Localization error of points without a stated one. Only ratios matter: the size of the errors is
estimated from the residuals."""


@dataclass(frozen=True)
class Choices:
    """What the user has changed about the pairs.

    Attributes:
        excluded: labels of pairs that are left out.
        renamed: label in the moving list → label that it belongs to.
        fle: label → localization error, RMS length in mm, of points that do not have the usual one.
    """

    excluded: frozenset[str] = frozenset()
    renamed: tuple[tuple[str, str], ...] = ()
    fle: tuple[tuple[str, float], ...] = ()

    def without(self, labels: tuple[str, ...]) -> Choices:
        """Return the choices with some more pairs left out."""
        return replace(self, excluded=self.excluded | set(labels))

    def localized(self, label: str, fleMm: float) -> Choices:
        """Return the choices with the localization error of a point, on top of before."""
        sizes = {**dict(self.fle), label: fleMm}
        if fleMm == USUAL_FLE_MM:
            del sizes[label]
        return replace(self, fle=tuple(sorted(sizes.items())))

    def weights(self, labels: Sequence[str]) -> np.ndarray | None:
        """Return the weight of each point, 1/FLE², (n,) float; None where all count alike."""
        sizes = dict(self.fle)
        fle = np.array([sizes.get(label, USUAL_FLE_MM) for label in labels])
        return None if (fle == USUAL_FLE_MM).all() else 1.0 / fle**2

    def rename(self, order: dict[str, str]) -> Choices:
        """Return the choices with moving points given to other labels, on top of before."""
        names = dict(self.renamed)
        shown = {label: names.get(label, label) for label in {*order, *names}}
        renamed = sorted((label, order.get(name, name)) for label, name in shown.items())
        return replace(self, renamed=tuple(renamed))


@dataclass(frozen=True)
class Pairs:
    """Paired points, mm.

    Attributes:
        labels: one for each pair, in the order of the moving list.
        moving: (n, 3) float, in the moving list's own frame.
        fixed: (n, 3) float, RAS.
        missing: labels of fixed points that have no partner yet.
        excluded: labels of the pairs that were left out.
    """

    labels: tuple[str, ...]
    moving: np.ndarray
    fixed: np.ndarray
    missing: tuple[str, ...] = ()
    excluded: tuple[str, ...] = ()


def readPairs(moving: Any, fixed: Any, choices: Choices) -> Pairs:
    """Return the pairs of two `vtkMRMLMarkupsNode`, by label where both lists are labeled.

    Fixed points that were not touched yet are allowed: a trial may be running.

    Raises:
        InputError: a list is empty, or its points do not pair up.
    """
    for node, words in ((moving, _("moving")), (fixed, _("fixed"))):
        if node is None:
            raise InputError(_("Choose the list of {which} points.").format(which=words))
        if node.GetNumberOfControlPoints() == 0:
            raise InputError(_("The list of {which} points is empty.").format(which=words))
    movingList = PointList(_renamed(labelsOf(moving), choices), localPoints(moving))
    fixedList = PointList(labelsOf(fixed), worldPoints(fixed))
    missing: tuple[str, ...] = ()
    if movingList.labels and fixedList.labels:
        touched = set(movingList.labels)
        missing = tuple(label for label in fixedList.labels if label not in touched)
        kept = [row for row, label in enumerate(fixedList.labels) if label in touched]
        if kept:
            fixedList = PointList(tuple(fixedList.labels[r] for r in kept), fixedList.points[kept])
    labels, movingPoints, fixedPoints = pair(movingList, fixedList)
    rows = [row for row, label in enumerate(labels) if label not in choices.excluded]
    return Pairs(
        tuple(labels[row] for row in rows),
        movingPoints[rows],
        fixedPoints[rows],
        missing,
        tuple(label for label in labels if label in choices.excluded),
    )


def snapshot(node: Any, pointsOf: Callable[[Any], np.ndarray] = worldPoints) -> tuple:
    """Return a value that changes with a list: its ID, labels and positions."""
    if node is None:
        return ()
    return node.GetID(), labelsOf(node), pointsOf(node).tobytes()


def _renamed(labels: tuple[str, ...], choices: Choices) -> tuple[str, ...]:
    names = dict(choices.renamed)
    return tuple(names.get(label, label) for label in labels)


@dataclass(frozen=True)
class Remedy:
    """A warning with its button.

    Attributes:
        warning: with its sentence and its points.
        title: of the button; empty where only the points themselves can be mended.
        choices: of the pairs once the button is pressed.
    """

    warning: RegistrationWarning
    title: str
    choices: Choices


def remedies(registration: Registration, choices: Choices) -> tuple[Remedy, ...]:
    """Return each warning of a rigid registration with what one click can do about it."""
    return tuple(_remedy(warning, registration, choices) for warning in registration.warnings)


def _remedy(warning: RegistrationWarning, registration: Registration, choices: Choices) -> Remedy:
    if warning.code == "outlier":
        return _leaveOut(warning, warning.points, choices)
    if warning.code == "duplicate":
        # The first of them may stay: one point at a place is no duplicate.
        return _leaveOut(warning, _laterTwins(warning, registration), choices)
    if warning.code == "order":
        order = find_order(registration.moving_mm, registration.fixed_mm)
        if order is not None:
            labels = registration.labels
            names = {labels[source]: labels[row] for row, source in enumerate(order)}
            changed = {old: new for old, new in names.items() if old != new}
            return Remedy(warning, _("Put in order"), choices.rename(changed))
    return Remedy(warning, "", choices)


def _leaveOut(warning: RegistrationWarning, labels: tuple[str, ...], choices: Choices) -> Remedy:
    title = _("Leave out {labels}").format(labels=", ".join(labels))
    return Remedy(warning, title, choices.without(labels))


def _laterTwins(warning: RegistrationWarning, registration: Registration) -> tuple[str, ...]:
    """Return the labels of the points that lie where an earlier one lies."""
    later: list[str] = []
    for points in (registration.moving_mm, registration.fixed_mm):
        limit = SAME_PLACE * np.linalg.norm(extents(points))
        rows = [registration.labels.index(label) for label in warning.points]
        for position, row in enumerate(rows):
            gaps = np.linalg.norm(points[rows[:position]] - points[row], axis=1)
            if (gaps <= limit).any() and registration.labels[row] not in later:
                later.append(registration.labels[row])
    return tuple(later)


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
