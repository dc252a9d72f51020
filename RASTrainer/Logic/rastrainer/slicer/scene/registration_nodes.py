"""A registration in the scene: its two lists of points, what the user changed, and its result."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import slicer

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, pair
from rastrainer.registration.fits import extents
from rastrainer.registration.registration import Registration
from rastrainer.registration.warnings import SAME_PLACE, RegistrationWarning, find_order
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.scene.nodes import (
    Role,
    findNode,
    findOrAddNode,
    labelsOf,
    localPoints,
    worldPoints,
)
from rastrainer.slicer.scene.robot import placeRobot
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


MOVING_REFERENCE = "RASTrainer.moving"
FIXED_REFERENCE = "RASTrainer.fixed"
KIND_ATTRIBUTE = "RASTrainer.registration"
FRE_ATTRIBUTE = "RASTrainer.freMm"


def showRegistration(scene: Any, registration: Registration, moving: Any, fixed: Any) -> Any:
    """Put a registration into the scene's WorldToHead transform and return that node.

    The node remembers its lists of points. Whether it is applied to the moving points stays as it
    was; the first time it is.
    """
    node = findOrAddNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD, "WorldToHead")
    isFirst = movingNode(node) is None
    node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(registration.matrix))
    rememberLists(node, moving, fixed)
    node.SetAttribute(KIND_ATTRIBUTE, registration.kind)
    node.SetAttribute(FRE_ATTRIBUTE, f"{registration.fre_mm:.6f}")
    if isFirst:
        setApplied(node, True)
    return node


def rememberLists(transformNode: Any, moving: Any, fixed: Any) -> None:
    """Store in the transform which lists of points it was computed from."""
    transformNode.SetNodeReferenceID(MOVING_REFERENCE, moving.GetID())
    transformNode.SetNodeReferenceID(FIXED_REFERENCE, fixed.GetID())


def movingNode(transformNode: Any) -> Any | None:
    """Return the list of touched points that the transform was made from, if it still exists."""
    return transformNode.GetNodeReference(MOVING_REFERENCE)


def isApplied(transformNode: Any) -> bool:
    """Return whether the touched points are shown on the head."""
    moving = movingNode(transformNode)
    return moving is not None and moving.GetTransformNodeID() == transformNode.GetID()


def setApplied(transformNode: Any, applied: bool) -> None:
    """Show the touched points on the head, or where they are in the robot's World."""
    moving = movingNode(transformNode)
    if moving is not None:
        moving.SetAndObserveTransformNodeID(transformNode.GetID() if applied else None)
        if moving.GetDisplayNode() is not None:
            # On the head, the fiducials beside them have the same numbers.
            moving.GetDisplayNode().SetPointLabelsVisibility(not applied)


def matrixOf(transformNode: Any) -> np.ndarray:
    """Return the transform to the parent, (4, 4) float, mm."""
    return slicer.util.arrayFromTransformMatrix(transformNode)


PLANNED = "planned"


def showPlannedPlace(scene: Any, scenario: Scenario, moving: Any, fixed: Any) -> Any:
    """Place World as the scenario plans it, and return the WorldToHead transform.

    The head of a trial is placed a little differently; only its registration shows where.
    """
    known = findNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
    wasApplied = known is None or isApplied(known)
    node = findOrAddNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD, "WorldToHead")
    matrix = transforms.inverse(scenario.head_to_world)
    node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(matrix))
    node.SetAttribute(KIND_ATTRIBUTE, PLANNED)
    node.RemoveAttribute(FRE_ATTRIBUTE)
    rememberLists(node, moving, fixed)
    setApplied(node, wasApplied)
    return node


def isPlanned(transform: Any) -> bool:
    """Return whether the transform is the planned pose rather than a registration."""
    return transform.GetAttribute(KIND_ATTRIBUTE) == PLANNED


def followPlacement(scene: Any) -> None:
    """Show the robot where the touched points are shown: at the head, or in World."""
    node = findNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
    placeRobot(scene, node if node is not None and isApplied(node) else None)
