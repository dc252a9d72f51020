"""The landmarks of a scenario's head: placed, proposed, undone, checked, and saved in a copy of it.

The order of the list in the scene is that of touching; the module Markups can change it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

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
    """Names, and positions (n, 3) float, RAS mm."""

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
        placed = self._placed()
        return tuple(map(Landmark, placed.names, placed.places))

    @property
    def missing(self) -> tuple[str, ...]:
        placed = self._placed().names
        return tuple(name for name in FACE_LANDMARKS if name not in placed)

    def show(self, landmarks: Sequence[Landmark]) -> None:
        """Replace all landmarks."""
        self._keep()
        self._set(
            _Placed(
                tuple(each.name for each in landmarks),
                np.array([each.position_ras for each in landmarks], dtype=float).reshape(-1, 3),
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
        """Replace the landmarks in the scene by proposed ones; return a sentence about them.

        Args:
            scenario: whose head it is.
            progress: see `ScenarioFiles`.
        """
        with tempfile.TemporaryDirectory() as temporary:
            path = Path(temporary) / FILE
            words = ["landmarks", str(scenario.folder), str(path), "--propose"]
            sentence = self._files.run(words, progress)
            proposed = read_markups(path)
        places = np.array(proposed.points, dtype=float)
        self.points.show([*map(Landmark, proposed.labels or (), places)])
        return sentence

    def check(self, scenario: Scenario, progress: Progress = no_progress) -> str:
        """Return the faults of the landmarks on the head of a scenario, or that there are none.

        Args:
            scenario: whose head it is.
            progress: see `ScenarioFiles`.
        """
        with self._written() as path:
            words = ["landmarks", str(scenario.folder), str(path)]
            return self._files.run(words, progress, mayFail=True)

    def save(self, scenario: Scenario, title: str, progress: Progress = no_progress) -> Scenario:
        """Copy a scenario with the landmarks of the scene, and return the copy.

        Args:
            scenario: which stays as it is.
            title: of the copy.
            progress: see `ScenarioFiles`.
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
