"""The landmarks of a scenario's head: placed, proposed, undone, checked, and saved in a copy of it.

Landmarks are touched in the order of the list in the scene; the module Markups can change it.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_files import read_markups, write_markups
from rastrainer.scenario.points import Landmark
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.scenario_files import ScenarioFiles
from rastrainer.slicer.scene.nodes import Role, usedPoints
from rastrainer.slicer.scene.plan_points import (
    PlacedPoint,
    UndoablePoints,
    placedPoints,
    putPoints,
    startPlacing,
)
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress

FILE = "landmarks.mrk.json"


class LandmarkPoints(UndoablePoints):
    """Places, replaces and removes landmarks.

    Points that are deselected in the module Markups are left out, but kept.
    """

    def placed(self, areSelected: bool = True) -> tuple[Landmark, ...]:
        """Return the landmarks that are selected, or the others, in the order of touching."""
        points = placedPoints(Role.LANDMARKS.find(self._scene), inRas=True)
        return tuple(
            Landmark(point.label, np.array(point.position))
            for point in points
            if point.isSelected == areSelected
        )

    def show(self, landmarks: Sequence[Landmark]) -> None:
        node = Role.LANDMARKS.make(self._scene)
        self.remember(node)
        putPoints(node, [PlacedPoint(each.name, each.position_ras.tolist()) for each in landmarks])

    def startPlacing(self, name: str) -> None:
        """Let the next click in a view place a landmark, in place of one of the same name."""
        node = Role.LANDMARKS.make(self._scene)
        points = self.remember(node)
        if name in [point.label for point in points]:
            putPoints(node, [point for point in points if point.label != name])
        # The new point gets this as its label.
        node.SetControlPointLabelFormat(name.replace("%", "%%"))
        startPlacing(self._scene, node)

    def remove(self, row: int) -> None:
        """Remove the landmark of a row of those that are `placed` and selected."""
        if 0 <= row < len(self.placed()):
            node = Role.LANDMARKS.make(self._scene)
            points = self.remember(node)
            points.remove([point for point in points if point.isSelected][row])
            putPoints(node, points)

    @contextmanager
    def written(self) -> Iterator[Path]:
        """Yield a file of the landmarks, in the order of touching."""
        if not self.placed():
            raise InputError(_("Place landmarks first, or have them proposed."))
        with tempfile.TemporaryDirectory() as temporary:
            path = Path(temporary) / FILE
            write_markups(path, usedPoints(Role.LANDMARKS.make(self._scene)))
            yield path

    def propose(self, files: ScenarioFiles, scenario: Scenario, progress: Progress) -> str:
        """Propose landmarks in place of those in the scene; return a sentence about them."""
        with tempfile.TemporaryDirectory() as temporary:
            path = Path(temporary) / FILE
            words = ["landmarks", str(scenario.folder), str(path), "--propose"]
            sentence = files.run(words, progress)
            proposed = read_markups(path)
        places = np.array(proposed.points, dtype=float)
        self.show([*map(Landmark, proposed.labels or (), places)])
        return sentence

    def check(self, files: ScenarioFiles, scenario: Scenario, progress: Progress) -> str:
        """Return the faults of the landmarks on the head of a scenario, or that there are none."""
        with self.written() as path:
            words = ["landmarks", str(scenario.folder), str(path)]
            return files.run(words, progress, mayFail=True)
