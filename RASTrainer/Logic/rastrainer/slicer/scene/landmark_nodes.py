"""The landmarks of a head in the scene: a list that the user places, and what can be undone in it.

The order of the list is that of touching; the module Markups can change it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.scenario.points import FACE_LANDMARKS, Landmark
from rastrainer.slicer.scene.control_points import labelOf, setPoints, worldPoints
from rastrainer.slicer.scene.plan_points import LIST, placedRows, startPlacing, stopPlacing
from rastrainer.slicer.scene.scene import Role, findNode, findOrAddNode
from rastrainer.slicer.translation import _

COLOR = (0.1, 0.55, 0.9)


@dataclass(frozen=True, eq=False)
class _Placed:
    """Names, and places (n, 3) float, RAS mm."""

    names: tuple[str, ...]
    places: np.ndarray

    def isLike(self, other: _Placed) -> bool:
        return self.names == other.names and np.array_equal(self.places, other.places)


class LandmarkPoints:
    """Places, replaces and removes landmarks; each change can be undone, the last one first."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._before: list[_Placed] = []

    @property
    def landmarks(self) -> tuple[Landmark, ...]:
        """The placed ones, in the order of touching."""
        placed = self._placed()
        return tuple(map(Landmark, placed.names, placed.places))

    @property
    def missing(self) -> tuple[str, ...]:
        """The usual names that are not placed."""
        placed = self._placed().names
        return tuple(name for name in FACE_LANDMARKS if name not in placed)

    def show(self, landmarks: Sequence[Landmark]) -> None:
        """Replace all landmarks."""
        self._keep()
        self._set(
            _Placed(
                tuple(each.name for each in landmarks),
                np.array([each.position for each in landmarks], dtype=float).reshape(-1, 3),
            )
        )

    def startPlacing(self, name: str) -> None:
        """Let the next click in a view place a landmark, in place of one of the same name."""
        self._keep()
        placed = self._placed()
        rows = [row for row, each in enumerate(placed.names) if each != name]
        if len(rows) < len(placed.names):
            self._set(_Placed(tuple(placed.names[row] for row in rows), placed.places[rows]))
        node = self._list()
        # The new point gets this as its label.
        node.SetControlPointLabelFormat(name.replace("%", "%%"))
        startPlacing(self._scene, node)

    def remove(self, row: int) -> None:
        """Remove the landmark of a row."""
        placed = self._placed()
        if not 0 <= row < len(placed.names):
            return
        self._keep()
        names = tuple(name for index, name in enumerate(placed.names) if index != row)
        self._set(_Placed(names, np.delete(placed.places, row, axis=0)))

    @property
    def canUndo(self) -> bool:
        """Whether a change can be undone."""
        present = self._placed()
        return any(not before.isLike(present) for before in self._before)

    def undo(self) -> None:
        """Undo the last change."""
        stopPlacing(self._scene)
        present = self._placed()
        while self._before:
            before = self._before.pop()
            if not before.isLike(present):
                self._set(before)
                return

    def forget(self) -> None:
        """Forget what could be undone: the scene was closed."""
        self._before.clear()

    def _keep(self) -> None:
        stopPlacing(self._scene)
        self._before.append(self._placed())

    def _placed(self) -> _Placed:
        node = findNode(self._scene, LIST, Role.LANDMARKS)
        if node is None:
            return _Placed((), np.empty((0, 3)))
        rows = list(placedRows(node))
        return _Placed(tuple(labelOf(node, row) for row in rows), worldPoints(node)[rows])

    def _set(self, placed: _Placed) -> None:
        setPoints(self._list(), placed.names, placed.places)

    def _list(self) -> Any:
        node = findOrAddNode(self._scene, LIST, Role.LANDMARKS, _("Landmarks"))
        display = node.GetDisplayNode()
        display.SetSelectedColor(COLOR)
        display.SetOccludedVisibility(True)
        return node
