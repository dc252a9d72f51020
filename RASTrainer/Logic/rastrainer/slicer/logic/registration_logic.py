"""The registration that the user sees: updated, corrected, undone, and shown in the scene."""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.registration.fits import RIGID
from rastrainer.registration.localization_error import LocalizationError
from rastrainer.registration.registration import Registration, register_all_kinds
from rastrainer.registration.target_error import TargetError, target_error
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.error_colors import (
    clearResidualArrows,
    colorHead,
    removeHeadColors,
    showResidualArrows,
)
from rastrainer.slicer.scene.nodes import Role, findNode, localPoints, worldPoints
from rastrainer.slicer.scene.registration_input import (
    Choices,
    Pairs,
    Remedy,
    SkinNormals,
    readPairs,
    remedies,
    snapshot,
)
from rastrainer.slicer.scene.scenario_nodes import TASK_ATTRIBUTE
from rastrainer.slicer.scene.tables import showFits, showResiduals
from rastrainer.slicer.scene.trial_scene import checkSameTask, showRegistration
from rastrainer.slicer.signal import Signal


@dataclass(frozen=True)
class Comparison:
    """The fits of the same pairs side by side.

    Attributes:
        pairs: what was registered.
        fits: by kind; those that the pairs allow, rigid always.
        errors: by kind, what to expect at the target; those that are known.
        remedies: the warnings, each with what one click can do.
    """

    pairs: Pairs
    fits: Mapping[str, Registration]
    errors: Mapping[str, TargetError]
    remedies: tuple[Remedy, ...]


class RegistrationLogic:
    """Registers two lists of the scene whenever one of them changes.

    Nodes are searched in every turn: any of them may be deleted at any time.

    Attributes:
        changed: emits nothing, whenever `comparison` or `problem` has changed.
        comparison: the present fits; None where there are none.
        problem: why there are none, a sentence; empty otherwise.
        leaveOneOut: of the shown fit, how far each touch lies from where the other pairs put it,
            mm; None if they are too few.
        kind: of the fit that the transform and the arrows show.
        isHeadColored: the head shows the target error to expect.
    """

    def __init__(self, scene: Any, work: BackgroundWork | None = None) -> None:
        """Without `work` everything is done at once.

        With it, a head that is new is prepared in the background, and what follows from a changed
        list is computed in one turn and shown in the next, as both take long.
        """
        self.changed = Signal()
        self.comparison: Comparison | None = None
        self.problem = ""
        self.leaveOneOut: np.ndarray | None = None
        self.kind = RIGID
        self.isHeadColored = False
        self._scene = scene
        self._work = work
        self._movingId = ""
        self._fixedId = ""
        self._targetId = ""
        self._history: list[Choices] = [Choices()]
        self._seen: tuple = ()
        self._normals = SkinNormals(work)
        self._normals.found.connect(self._compute)

    @property
    def choices(self) -> Choices:
        """What the user has changed about the pairs."""
        return self._history[-1]

    @property
    def canUndo(self) -> bool:
        """Whether there is a change to undo."""
        return len(self._history) > 1

    @property
    def shown(self) -> Registration | None:
        """The fit of the chosen kind; the rigid one where the pairs do not allow that kind."""
        if self.comparison is None:
            return None
        return self.comparison.fits.get(self.kind, self.comparison.fits[RIGID])

    def moving(self) -> Any | None:
        """Return the chosen list of moving points; the touches where none is chosen."""
        return self._chosen(self._movingId) or findNode(
            self._scene, "vtkMRMLMarkupsFiducialNode", Role.CAPTURED_POINTS
        )

    def fixed(self) -> Any | None:
        """Return the chosen list of fixed points; the task's fiducials where none is chosen."""
        return self._chosen(self._fixedId) or findNode(
            self._scene, "vtkMRMLMarkupsFiducialNode", Role.FIXED_FIDUCIALS
        )

    def target(self) -> Any | None:
        """Return the list whose first point is the target; the scenario's where none is chosen."""
        return self._chosen(self._targetId) or findNode(
            self._scene, "vtkMRMLMarkupsFiducialNode", Role.TARGET
        )

    def transform(self) -> Any | None:
        """Return the transform node of the result, if there is one."""
        return findNode(self._scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)

    def chooseLists(self, moving: Any | None, fixed: Any | None) -> None:
        """Choose what is registered; None means the touches and the task's fiducials."""
        ids = (moving.GetID() if moving else "", fixed.GetID() if fixed else "")
        if ids != (self._movingId, self._fixedId):
            self._movingId, self._fixedId = ids
            self.reset()

    def chooseTarget(self, target: Any | None) -> None:
        """Choose where the error is reported: a list's first point, None for the scenario's."""
        self._targetId = target.GetID() if target else ""

    def chooseKind(self, kind: str) -> None:
        """Choose which fit the transform and the arrows show."""
        self.kind = kind
        self._compute()

    def setHeadColored(self, colored: bool) -> None:
        """Color the head by the target error to expect, or not."""
        self.isHeadColored = colored
        self._colorHead()

    def change(self, choices: Choices) -> None:
        """Register the pairs with these changes; `undo` reverts them."""
        if choices != self.choices:
            self._history.append(choices)
            self._compute()

    def exclude(self, *labels: str) -> None:
        """Leave pairs out."""
        self.change(self.choices.without(labels))

    def localize(self, label: str, fleMm: float) -> None:
        """State how well a point is localized, RMS length in mm; the rigid fit weights it so."""
        self.change(self.choices.localized(label, fleMm))

    def undo(self) -> None:
        """Undo the last change."""
        if self.canUndo:
            self._history.pop()
            self._compute()

    def reset(self) -> None:
        """Forget the changes: what comes next is another trial."""
        self._history = [Choices()]
        self._seen = ()

    def forgetScene(self) -> None:
        """Forget lists and result: the scene was cleared, and the next nodes may have their IDs."""
        self._movingId = self._fixedId = self._targetId = ""
        self.reset()
        self._compute()

    def process(self) -> None:
        """Register again if a list or the target has changed."""
        seen = self._snapshot()
        if seen == self._seen:
            return
        work = self._work
        if work is None:
            self._compute()
            return
        self._seen = seen
        work.later(lambda: self._registerNow(work))

    def _snapshot(self) -> tuple:
        moving, fixed = self.moving(), self.fixed()
        tasks = [node and node.GetAttribute(TASK_ATTRIBUTE) for node in (moving, fixed)]
        return snapshot(moving, localPoints), snapshot(fixed), snapshot(self.target()), *tasks

    def _compute(self) -> None:
        self._register()
        self._show()

    def _register(self) -> None:
        self.comparison, self.problem, self.leaveOneOut = None, "", None
        moving, fixed = self.moving(), self.fixed()
        if moving is None or moving.GetNumberOfControlPoints() == 0:
            self.reset()
        # The key of the present registration, so that lists that change back count as changed.
        self._seen = self._snapshot()
        try:
            checkSameTask(moving, fixed)
            pairs = readPairs(moving, fixed, self.choices)
            self.comparison = self._compare(pairs)
        except InputError as error:
            self.problem = str(error)
        if self.shown is not None:
            with contextlib.suppress(InputError):
                self.leaveOneOut = self.shown.leave_one_out_mm()

    def _registerNow(self, work: BackgroundWork) -> None:
        self._register()
        comparison = self.comparison
        work.later(lambda: self._showIfPresent(comparison))

    def _showIfPresent(self, comparison: Comparison | None) -> None:
        """Show the result of the last turn, unless it is outdated or its lists were removed."""
        if self.comparison is comparison:
            areGone = comparison is not None and None in (self.moving(), self.fixed())
            if not areGone:
                self._show()

    def _compare(self, pairs: Pairs) -> Comparison:
        weights = self.choices.weights(pairs.labels)
        fits = register_all_kinds(pairs.moving, pairs.fixed, pairs.labels, weights)
        errors = {}
        position = self.targetPosition()
        for kind, fit in fits.items():
            with contextlib.suppress(InputError):
                if position is not None:
                    errors[kind] = self.targetError(fit, position)
        return Comparison(pairs, fits, errors, remedies(fits[RIGID], self.choices))

    def targetError(self, fit: Registration, position: np.ndarray) -> TargetError:
        """Return the error to expect with a fit at a place, (3,) float, RAS mm.

        Raises:
            InputError: the fit has too few points.
        """
        return target_error(fit, position, self._errorOnSkin(fit))

    def _errorOnSkin(self, fit: Registration) -> LocalizationError | None:
        if fit.weights is not None:
            # Errors stated for single points replace those estimated from the skin.
            return None
        fixed = self.fixed()
        expected = None if fixed is None else worldPoints(fixed)
        return self._normals.errorOnSkin(self._head(), fit, expected)

    def targetPosition(self) -> np.ndarray | None:
        """Return the target, (3,) float, RAS mm; None where there is none."""
        target = self.target()
        if target is None or target.GetNumberOfControlPoints() == 0:
            return None
        return np.array(target.GetNthControlPointPositionWorld(0))

    def _show(self) -> None:
        if self.comparison is None or self.shown is None:
            clearResidualArrows(self._scene)
        else:
            self._showFits(self.comparison, self.shown)
        self._colorHead()
        self.changed.emit()

    def _showFits(self, comparison: Comparison, shown: Registration) -> None:
        showRegistration(self._scene, shown, self.moving(), self.fixed())
        without = None if self.leaveOneOut is None else self.leaveOneOut.tolist()
        showResiduals(self._scene, shown, without)
        fits = comparison.fits
        showFits(self._scene, list(fits.values()), [comparison.errors.get(k) for k in fits])
        showResidualArrows(self._scene, shown)

    def _colorHead(self) -> None:
        head = self._head()
        if head is None or head.GetPolyData() is None:
            return
        if self.isHeadColored and self.shown is not None:
            with contextlib.suppress(InputError):
                colorHead(head, self.shown, self._errorOnSkin(self.shown))
                return
        removeHeadColors(head)

    def _head(self) -> Any | None:
        return findNode(self._scene, "vtkMRMLModelNode", Role.HEAD_MODEL)

    def _chosen(self, nodeId: str) -> Any | None:
        return self._scene.GetNodeByID(nodeId) if nodeId else None
