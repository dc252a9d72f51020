"""The landmarks of a scenario's head: placed, proposed, undone, checked, and saved in a copy of it.

The order of the list in the scene is that of touching; the module Markups can change it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import compress
from operator import not_
from pathlib import Path
from typing import Any

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.files.point_files import read_markups, write_markups
from rastrainer.files.point_list import PointList
from rastrainer.scenario.points import FACE_LANDMARKS, Landmark
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.logic.scenario_logic import ScenarioFiles
from rastrainer.slicer.scene.nodes import (
    Role,
    findNode,
    findOrAddNode,
    isUsed,
    labelOf,
    setPoints,
    worldPoints,
)
from rastrainer.slicer.scene.plan_points import LIST, placedRows, startPlacing, stopPlacing
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress, no_progress

COLOR = (0.1, 0.55, 0.9)


@dataclass(frozen=True, eq=False)
class _Placed:
    """Names, positions (n, 3) float, RAS mm, and which points are selected."""

    names: tuple[str, ...]
    places: np.ndarray
    selected: tuple[bool, ...]

    def isLike(self, other: _Placed) -> bool:
        isSame = (self.names, self.selected) == (other.names, other.selected)
        return isSame and np.array_equal(self.places, other.places)

    def without(self, rows: Sequence[int]) -> _Placed:
        kept = [row for row in range(len(self.names)) if row not in rows]
        return _Placed(
            tuple(self.names[row] for row in kept),
            self.places[kept],
            tuple(self.selected[row] for row in kept),
        )


class LandmarkPoints:
    """Places, replaces and removes landmarks; each change can be undone, the last one first.

    Points that are deselected in the module Markups are left out, but kept.
    """

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._before: list[_Placed] = []

    @property
    def landmarks(self) -> tuple[Landmark, ...]:
        placed = self._placed()
        points = zip(placed.names, placed.places, placed.selected, strict=True)
        return tuple(Landmark(name, place) for name, place, isSelected in points if isSelected)

    @property
    def deselected(self) -> tuple[str, ...]:
        placed = self._placed()
        return tuple(compress(placed.names, map(not_, placed.selected)))

    @property
    def missing(self) -> tuple[str, ...]:
        placed = [landmark.name for landmark in self.landmarks]
        return tuple(name for name in FACE_LANDMARKS if name not in placed)

    def show(self, landmarks: Sequence[Landmark]) -> None:
        """Replace all landmarks."""
        self._keep()
        self._set(
            _Placed(
                tuple(each.name for each in landmarks),
                np.array([each.position_ras for each in landmarks], dtype=float).reshape(-1, 3),
                (True,) * len(landmarks),
            )
        )

    def startPlacing(self, name: str) -> None:
        """Let the next click in a view place a landmark, in place of one of the same name."""
        self._keep()
        placed = self._placed()
        if name in placed.names:
            self._set(placed.without([row for row, n in enumerate(placed.names) if n == name]))
        node = self._list()
        # The new point gets this as its label.
        node.SetControlPointLabelFormat(name.replace("%", "%%"))
        startPlacing(self._scene, node)

    def remove(self, row: int) -> None:
        """Remove the landmark of a row of `landmarks`."""
        placed = self._placed()
        rows = [index for index, isSelected in enumerate(placed.selected) if isSelected]
        if 0 <= row < len(rows):
            self._keep()
            self._set(placed.without(rows[row : row + 1]))

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
            return _Placed((), np.empty((0, 3)), ())
        rows = list(placedRows(node))
        return _Placed(
            tuple(labelOf(node, row) for row in rows),
            worldPoints(node)[rows],
            tuple(isUsed(node, row) for row in rows),
        )

    def _set(self, placed: _Placed) -> None:
        node = self._list()
        with slicer.util.NodeModify(node):
            setPoints(node, placed.names, placed.places)
            for row, isSelected in enumerate(placed.selected):
                node.SetNthControlPointSelected(row, isSelected)

    def _list(self) -> Any:
        node = findOrAddNode(self._scene, LIST, Role.LANDMARKS, _("Landmarks"))
        display = node.GetDisplayNode()
        display.SetSelectedColor(COLOR)
        display.SetOccludedVisibility(True)
        return node


FILE = "landmarks.mrk.json"


class LandmarkLogic:
    """What the Landmarks panel does.

    Attributes:
        points: the landmarks in the scene.
    """

    def __init__(self, scene: Any, files: ScenarioFiles) -> None:
        self.points = LandmarkPoints(scene)
        self._files = files

    def propose(self, scenario: Scenario, progress: Progress = no_progress) -> str:
        """Replace the landmarks in the scene by proposed ones; return a sentence about them."""
        with tempfile.TemporaryDirectory() as temporary:
            path = Path(temporary) / FILE
            words = ["landmarks", str(scenario.folder), str(path), "--propose"]
            sentence = self._files.run(words, progress)
            proposed = read_markups(path)
        places = np.array(proposed.points, dtype=float)
        self.points.show([*map(Landmark, proposed.labels or (), places)])
        return sentence

    def check(self, scenario: Scenario, progress: Progress = no_progress) -> str:
        """Return the faults of the landmarks on the head of a scenario, or that there are none."""
        with self._written() as path:
            words = ["landmarks", str(scenario.folder), str(path)]
            return self._files.run(words, progress, mayFail=True)

    def save(self, scenario: Scenario, title: str, progress: Progress = no_progress) -> Scenario:
        """Copy a scenario with the landmarks of the scene, and return the copy.

        Args:
            scenario: which stays as it is.
        """
        with self._written() as path:
            plan = ["--landmarks", str(path)]
            return self._files.saveWith(plan, scenario.name, title, progress)

    @contextmanager
    def _written(self) -> Iterator[Path]:
        landmarks = self.points.landmarks
        if not landmarks:
            raise InputError(_("Place landmarks first, or have them proposed."))
        with tempfile.TemporaryDirectory() as temporary:
            path = Path(temporary) / FILE
            names = tuple(landmark.name for landmark in landmarks)
            write_markups(
                path, PointList(names, np.array([each.position_ras for each in landmarks]))
            )
            yield path
