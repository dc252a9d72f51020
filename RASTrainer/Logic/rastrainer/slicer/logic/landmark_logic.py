"""The landmarks of a scenario's head: proposed, placed, checked, and saved in a copy of it."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList, read_markups, write_markups
from rastrainer.progress import Progress, no_progress
from rastrainer.scenario.points import Landmark
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.logic.scenario_logic import ScenarioFiles
from rastrainer.slicer.scene.landmark_nodes import LandmarkPoints
from rastrainer.slicer.translation import _

FILE = "landmarks.mrk.json"


class LandmarkLogic:
    """What the Landmarks panel does.

    Attributes:
        points: the landmarks in the scene.
    """

    def __init__(self, scene: Any, files: ScenarioFiles) -> None:
        """`files` keeps landmarks in scenarios."""
        self.points = LandmarkPoints(scene)
        self._files = files

    def propose(self, scenario: Scenario, progress: Progress = no_progress) -> str:
        """Replace the landmarks in the scene by proposed ones; return a sentence about them.

        Args:
            scenario: whose head it is.
            progress: see `ScenarioFiles`.

        Raises:
            InputError: the head cannot be used.
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
        """Return what is wrong with the landmarks on the head of a scenario, or that nothing is.

        Args:
            scenario: whose head it is.
            progress: see `ScenarioFiles`.

        Raises:
            InputError: no landmark is placed.
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

        Raises:
            InputError: there is one of that title already, or the landmarks cannot be used.
        """
        with self._written() as path:
            return self._files.saveWith("--landmarks", path, scenario.name, title, progress)

    @contextmanager
    def _written(self) -> Iterator[Path]:
        landmarks = self.points.landmarks
        if not landmarks:
            raise InputError(_("Place landmarks first, or have them proposed."))
        with tempfile.TemporaryDirectory() as temporary:
            path = Path(temporary) / FILE
            names = tuple(landmark.name for landmark in landmarks)
            write_markups(path, PointList(names, np.array([each.position for each in landmarks])))
            yield path
