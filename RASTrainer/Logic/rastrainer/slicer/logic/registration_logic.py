"""The registration that the user sees: updated, corrected, undone, and shown in the scene."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.logic.registration_comparison import (
    Comparison,
    ComparisonRequest,
    compareFits,
)
from rastrainer.slicer.scene.error_colors import (
    clearResidualArrows,
    colorHead,
    removeHeadColors,
    showResidualArrows,
)
from rastrainer.slicer.scene.nodes import Role, findNode, surfaceOf, worldPoints
from rastrainer.slicer.scene.registration_input import (
    Choices,
    Pairs,
    SkinReader,
    readPairs,
    snapshot,
)
from rastrainer.slicer.scene.scenario_nodes import TASK_ATTRIBUTE
from rastrainer.slicer.scene.tables import showFits, showResiduals
from rastrainer.slicer.scene.trial_scene import checkSameTask, showRegistration
from rastrainer.slicer.signal import Signal


class RegistrationLogic:
    """Registers two lists of the scene whenever one of them changes.

    Nodes are searched in every turn: any of them may be deleted at any time.

    Attributes:
        changed: emits nothing, whenever another `comparison` or `problem` is shown.
        comparison: the present fits; None where there are none.
        problem: why there are none, a sentence; empty otherwise.
        kind: of the fit that the transform and the arrows show.
        isHeadColored: the head shows the target error to expect.
    """

    def __init__(self, scene: Any, work: BackgroundWork | None = None) -> None:
        """Without `work` everything is done at once.

        With it, fits are computed in the background, and what they change in the scene is shown
        in several turns, as each takes Slicer's views long.
        """
        self.changed = Signal()
        self.comparison: Comparison | None = None
        self.problem = ""
        self.kind = RIGID
        self.isHeadColored = False
        self._scene = scene
        self._work = work
        self._movingId = ""
        self._fixedId = ""
        self._targetId = ""
        self._history: list[Choices] = [Choices()]
        self._seen: tuple = ()
        self._skins = SkinReader()
        self._request: ComparisonRequest | None = None

    @property
    def choices(self) -> Choices:
        """What the user has changed about the pairs."""
        return self._history[-1]

    @property
    def canUndo(self) -> bool:
        return len(self._history) > 1

    @property
    def shown(self) -> Registration | None:
        """The fit of the chosen kind; the rigid one where the pairs do not allow that kind."""
        return None if self.comparison is None else self.comparison.fitOf(self.kind)

    @property
    def leaveOneOut(self) -> np.ndarray | None:
        """How far each touch lies from where the other pairs put it in the shown fit, mm, or None.

        None if they are too few.
        """
        if self.comparison is None:
            return None
        return self.comparison.leaveOneOut.get(self.comparison.fitOf(self.kind).kind)

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
        if colored:
            self._compute()
        else:
            self._colorHead(None)

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
        """Register again if a list, the target or the head has changed."""
        if self._snapshot() != self._seen:
            self._compute()

    def _snapshot(self) -> tuple:
        moving, fixed = self.moving(), self.fixed()
        tasks = [node and node.GetAttribute(TASK_ATTRIBUTE) for node in (moving, fixed)]
        movingList = snapshot(moving, slicer.util.arrayFromMarkupsControlPoints)
        lists = movingList, snapshot(fixed), snapshot(self.target())
        return *lists, *tasks, surfaceOf(self._head())

    def _compute(self) -> None:
        """Register the lists as they are now; what is being computed is outdated."""
        moving, fixed = self.moving(), self.fixed()
        if moving is None or moving.GetNumberOfControlPoints() == 0:
            self.reset()
        # The key of the present registration, so that lists that change back count as changed.
        self._seen = self._snapshot()
        self._request = None
        self._prepareSkin(fixed)
        try:
            checkSameTask(moving, fixed)
            request = self._requestOf(readPairs(moving, fixed, self.choices))
        except InputError as error:
            self._refuse(error)
            return
        self._request = request
        if self._work is not None:
            self._work.do(
                lambda: compareFits(request) if request is self._request else None,
                lambda comparison: self._take(request, comparison),
                lambda error: self._refuse(error) if request is self._request else None,
            )
            return
        try:
            self._take(request, compareFits(request))
        except InputError as error:
            self._refuse(error)

    def _prepareSkin(self, fixed: Any | None) -> None:
        """Look for the normals at the fixed points before they are touched."""
        skin = self._skins.read(self._head())
        if self._work is None or skin is None or fixed is None:
            return
        points = worldPoints(fixed)
        if not skin.knows(points):
            self._work.do(lambda: skin.findNormals(points), lambda _none: None)

    def _requestOf(self, pairs: Pairs) -> ComparisonRequest:
        head = self._head()
        skin = self._skins.read(head)
        isColored = self.isHeadColored and skin is not None
        headPoints = slicer.util.arrayFromModelPoints(head).astype(float) if isColored else None
        return ComparisonRequest(
            pairs, self.choices, self.kind, self.targetPosition(), skin, headPoints
        )

    def _refuse(self, error: Exception) -> None:
        self.comparison, self.problem, self._request = None, str(error), None
        clearResidualArrows(self._scene)
        self._colorHead(None)
        self.changed.emit()

    def _take(self, request: ComparisonRequest, comparison: Comparison | None) -> None:
        """Show a comparison, each part in a separate turn, unless it is outdated."""
        if comparison is None:
            return
        for show in (self._showTransform, self._showTables, self._showOnHead, self._finish):
            if self._work is None:
                show(comparison)
            else:
                self._work.later(partial(self._showIfPresent, request, show, comparison))

    def _showIfPresent(
        self,
        request: ComparisonRequest,
        show: Callable[[Comparison], None],
        comparison: Comparison,
    ) -> None:
        """Show a part, unless it is outdated or its lists were removed."""
        if request is self._request and None not in (self.moving(), self.fixed()):
            show(comparison)

    def _showTransform(self, comparison: Comparison) -> None:
        showRegistration(self._scene, comparison.fitOf(self.kind), self.moving(), self.fixed())

    def _finish(self, comparison: Comparison) -> None:
        self.comparison, self.problem = comparison, ""
        self.changed.emit()

    def _showTables(self, comparison: Comparison) -> None:
        fits, shown = comparison.fits, comparison.fitOf(self.kind)
        showResiduals(self._scene, shown, comparison.leaveOneOut.get(shown.kind))
        showFits(self._scene, list(fits.values()), [comparison.errors.get(k) for k in fits])

    def _showOnHead(self, comparison: Comparison) -> None:
        showResidualArrows(self._scene, comparison.fitOf(self.kind))
        self._colorHead(comparison.headErrors if self.isHeadColored else None)

    def targetError(self, position: np.ndarray) -> TargetError | None:
        """Return the error to expect with the shown fit at a place, (3,) float, RAS mm.

        None where nothing is registered.
        """
        if self.comparison is None:
            return None
        return self.comparison.targetError(self.comparison.fitOf(self.kind), position)

    def targetPosition(self) -> np.ndarray | None:
        """Return the target, (3,) float, RAS mm; None where there is none."""
        target = self.target()
        if target is None or target.GetNumberOfControlPoints() == 0:
            return None
        return np.array(target.GetNthControlPointPositionWorld(0))

    def _colorHead(self, errors: np.ndarray | None) -> None:
        """Color the head by errors at its points, or show its own color where there are none."""
        head = self._head()
        if head is None:
            return
        if errors is None:
            removeHeadColors(head)
        else:
            colorHead(head, errors)

    def _head(self) -> Any | None:
        return findNode(self._scene, "vtkMRMLModelNode", Role.HEAD_MODEL)

    def _chosen(self, nodeId: str) -> Any | None:
        return self._scene.GetNodeByID(nodeId) if nodeId else None
