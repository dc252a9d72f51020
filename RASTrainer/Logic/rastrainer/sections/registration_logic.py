"""The registration that the user sees: its fits, computed, corrected, undone, and shown."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.registration.fits import RIGID
from rastrainer.registration.localization_error import LocalizationError
from rastrainer.registration.registration import Registration, register_all_kinds
from rastrainer.registration.target_error import TargetError, expected_tre, target_error
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.error_colors import (
    clearResidualArrows,
    colorHead,
    removeHeadColors,
    showResidualArrows,
)
from rastrainer.slicer.scene.nodes import TASK_ATTRIBUTE, Role, surfaceOf, worldPoints
from rastrainer.slicer.scene.registration_input import (
    Choices,
    Pairs,
    Remedy,
    SkinNormals,
    readPairs,
    readSkin,
    remedyOf,
    snapshot,
)
from rastrainer.slicer.scene.tables import showFits, showResiduals
from rastrainer.slicer.scene.trial_scene import checkSameTask, placeWorld
from rastrainer.slicer.signal import Signal


@dataclass(frozen=True, eq=False)
class Comparison:
    """The fits of the same pairs side by side, by kind; those that the pairs allow, rigid always.

    Attributes:
        shown: the fit of the wanted kind; the rigid one where the pairs do not allow that kind.
        localizations: along and across the skin; None if only an isotropic error is known.
        errors: what to expect at the target.
        leaveOneOut: (n,) float, mm, how far each touch lies from where the other pairs put it.
        headErrors: (v,) float, mm, expected at each point of a head that is to be colored.
    """

    pairs: Pairs
    shown: Registration
    fits: Mapping[str, Registration]
    localizations: Mapping[str, LocalizationError | None]
    errors: Mapping[str, TargetError]
    leaveOneOut: Mapping[str, np.ndarray]
    remedies: tuple[Remedy, ...]
    headErrors: np.ndarray | None

    def targetError(self, place: np.ndarray) -> TargetError:
        """Return the error to expect with the shown fit at a place, (3,) float, RAS mm."""
        return target_error(self.shown, place, self.localizations[self.shown.kind])


def compareFits(
    pairs: Pairs,
    choices: Choices,
    kind: str,
    target: np.ndarray | None,
    skin: SkinNormals | None,
    headPoints: np.ndarray | None,
) -> Comparison:
    """Register pairs, which were chosen by `choices`, in all ways; `kind` is shown.

    Errors are those at `target`, (3,) float, RAS mm, and at `headPoints`, (v, 3), of a head that is
    to be colored.
    """
    weights = choices.weights(pairs.labels)
    fits = register_all_kinds(pairs.moving, pairs.fixed, pairs.labels, weights)
    # Errors stated for single points replace those estimated from the skin.
    localizations = {
        kind: None if skin is None or fit.weights is not None else skin.localizationError(fit)
        for kind, fit in fits.items()
    }
    errors, leaveOneOut = {}, {}
    for each, fit in fits.items():
        with contextlib.suppress(InputError):
            if target is not None:
                errors[each] = target_error(fit, target, localizations[each])
        with contextlib.suppress(InputError):
            leaveOneOut[each] = fit.leave_one_out_mm()
    shown, headErrors = fits.get(kind, fits[RIGID]), None
    if headPoints is not None:
        with contextlib.suppress(InputError):
            headErrors = expected_tre(shown, headPoints, localizations[shown.kind])
    rigid = fits[RIGID]
    found = tuple(remedyOf(warning, rigid, choices) for warning in rigid.warnings)
    return Comparison(pairs, shown, fits, localizations, errors, leaveOneOut, found, headErrors)


Request = Callable[[], Comparison]


@dataclass(eq=False)
class RegistrationLogic:
    """Registers two lists of the scene whenever one of them changes.

    Nodes are searched in every turn: any of them may be deleted at any time. Fits are computed in
    the background, and shown in several turns, as each part takes Slicer's views long.

    Attributes:
        changed: emits nothing, whenever another `comparison` or `problem` is shown.
        problem: why there are no fits, a sentence; empty otherwise.
        kind: of the fit that the transform and the arrows show.
        isHeadColored: the head shows the target error to expect.
    """

    scene: Any
    work: BackgroundWork
    changed: Signal = field(default_factory=Signal)
    comparison: Comparison | None = None
    problem: str = ""
    kind: str = RIGID
    isHeadColored: bool = False
    _chosen: tuple[str, ...] = "", "", ""
    _history: tuple[Choices, ...] = (Choices(),)
    _seen: tuple = ()
    _surface: tuple = ()
    _skin: SkinNormals | None = None
    _request: Request | None = None

    @property
    def choices(self) -> Choices:
        return self._history[-1]

    @property
    def canUndo(self) -> bool:
        return len(self._history) > 1

    @property
    def transform(self) -> Any | None:
        return Role.WORLD_TO_HEAD.find(self.scene)

    def lists(self) -> list[Any | None]:
        """Return the moving points, the fixed points, and the list whose first is the target.

        The lists of the trial and its task stand in for lists that are not chosen.
        """
        chosen = [self.scene.GetNodeByID(each) if each else None for each in self._chosen]
        others = Role.CAPTURED_POINTS, Role.FIXED_FIDUCIALS, Role.TARGET
        return [node or kind.find(self.scene) for node, kind in zip(chosen, others, strict=True)]

    def chooseLists(self, *lists: Any | None) -> None:
        former = self._chosen
        self._chosen = tuple(node.GetID() if node else "" for node in lists)
        if self._chosen[:2] != former[:2]:
            self.reset()

    def chooseKind(self, kind: str) -> None:
        self.kind = kind
        self._compute()

    def setHeadColored(self, colored: bool) -> None:
        self.isHeadColored = colored
        self._compute() if colored else self._colorHead(None)

    def change(self, choices: Choices) -> None:
        if choices != self.choices:
            self._history += (choices,)
            self._compute()

    def undo(self) -> None:
        if self.canUndo:
            self._history = self._history[:-1]
            self._compute()

    def reset(self) -> None:
        """Forget the changes: another trial comes next."""
        self._history = (Choices(),)
        self._seen = ()

    def forgetScene(self) -> None:
        """Forget lists and result: the scene was cleared, and the next nodes may have their IDs."""
        self._chosen = "", "", ""
        self.reset()
        self._compute()

    def process(self) -> None:
        """Register again if a list, the target or the head has changed."""
        if self._snapshot() != self._seen:
            self._compute()

    def _snapshot(self) -> tuple:
        moving, fixed, target = self.lists()
        tasks = [node and node.GetAttribute(TASK_ATTRIBUTE) for node in (moving, fixed)]
        movingList = snapshot(moving, slicer.util.arrayFromMarkupsControlPoints)
        head = surfaceOf(Role.HEAD_MODEL.find(self.scene))
        return movingList, snapshot(fixed), snapshot(target), *tasks, head

    def _compute(self) -> None:
        """Register the lists as they are now; a running computation is outdated."""
        moving, fixed, target = self.lists()
        if moving is None or moving.GetNumberOfControlPoints() == 0:
            self.reset()
        # The key of the present registration, so that lists that change back count as changed.
        self._seen = self._snapshot()
        self._request = None
        head = Role.HEAD_MODEL.find(self.scene)
        if surfaceOf(head) != self._surface:
            self._surface, self._skin = surfaceOf(head), readSkin(head)
        skin = self._skin
        if skin is not None and fixed is not None and not skin.knows(worldPoints(fixed)):
            # Before they are touched: it takes long.
            self.work.do(partial(skin.findNormals, worldPoints(fixed)), lambda _none: None)
        try:
            checkSameTask(moving, fixed)
            pairs = readPairs(moving, fixed, self.choices)
        except InputError as error:
            self._refuse(error)
            return
        place = None
        if target is not None and target.GetNumberOfControlPoints():
            place = np.array(target.GetNthControlPointPositionWorld(0))
        isColored = self.isHeadColored and skin is not None
        points = slicer.util.arrayFromModelPoints(head).astype(float) if isColored else None
        request = partial(compareFits, pairs, self.choices, self.kind, place, skin, points)
        self._request = request
        self.work.do(
            lambda: request() if request is self._request else None,
            partial(self._take, request),
            lambda error: self._refuse(error) if request is self._request else None,
        )

    def _refuse(self, error: Exception) -> None:
        self.comparison, self.problem, self._request = None, str(error), None
        clearResidualArrows(self.scene)
        self._colorHead(None)
        self.changed.emit()

    def _take(self, request: Request, comparison: Comparison | None) -> None:
        """Show a comparison, each part in a separate turn, unless it is outdated."""
        if comparison is None:
            return
        scene, shown = self.scene, comparison.shown

        def finish() -> None:
            self.comparison, self.problem = comparison, ""
            self.changed.emit()

        def showIfWanted(show: Callable[[], object]) -> None:
            if request is self._request and None not in self.lists()[:2]:
                show()

        for show in (
            lambda: placeWorld(scene, shown.matrix, shown.kind, *self.lists()[:2]),
            lambda: showResiduals(scene, shown, comparison.leaveOneOut.get(shown.kind)),
            lambda: showFits(scene, comparison.fits, comparison.errors),
            lambda: showResidualArrows(scene, shown),
            lambda: self._colorHead(comparison.headErrors),
            finish,
        ):
            self.work.later(partial(showIfWanted, show))

    def _colorHead(self, errors: np.ndarray | None) -> None:
        head = Role.HEAD_MODEL.find(self.scene)
        if head is not None and errors is not None and self.isHeadColored:
            colorHead(head, errors)
        elif head is not None:
            removeHeadColors(head)
