"""The panels on a separate study, for the module's self tests: no user's study is changed."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import slicer

from rastrainer import transforms
from rastrainer.scenario.points import LABELS
from rastrainer.sections.application import callSoon, findPlaces
from rastrainer.sections.module_session import ModuleSession
from rastrainer.sections.panel_stack import PanelStack
from rastrainer.slicer.link.link import desktopKit
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.slicer.settings import Settings

SCENARIO = "colin27"
TASK = "task-1"
SEED = 3
NOISE_MM = 0.5


class SelfTestFixture:
    """A session and its panels, driven without a timer; to be used in a `with` statement."""

    def __init__(self, moduleFile: Path) -> None:
        def resourcePath(name: str) -> str:
            return str(moduleFile.parent / "Resources" / name)

        self._folder = tempfile.TemporaryDirectory(prefix="RASTrainer-")
        folder = Path(self._folder.name)
        # In memory only: a test changes no setting of the user.
        settings = Settings()
        places = replace(
            findPlaces(moduleFile, settings),
            study=folder / "study.db",
            records=folder / "trials",
            library=folder / "scenarios",
        )
        self.session = ModuleSession(slicer.mrmlScene, places, desktopKit, settings, callSoon)
        self._container = slicer.util.loadUI(resourcePath("UI/RASTrainer.ui"))
        self._container.setMRMLScene(slicer.mrmlScene)
        self._panels = PanelStack()
        for _step in self._panels.build(self._container, resourcePath, self.session):
            pass
        self.ui = self._panels.ui

    def __enter__(self) -> SelfTestFixture:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._panels.close()
        self.session.close()
        self._container.deleteLater()
        self._folder.cleanup()

    def process(self) -> None:
        """Do what the module's timers do, until nothing is left to be done."""
        self.session.process()
        while self.session.yieldTimeToWork():
            pass
        self.session.process()

    def touches(self) -> np.ndarray:
        """Return good touches of task 1, (15, 3) float, World, mm."""
        scenario = self.session.scenarios.find(SCENARIO)
        noise = np.random.default_rng(SEED).normal(0.0, NOISE_MM, (len(LABELS), 3))
        return transforms.apply(
            scenario.perturbed_head_to_world(SEED), scenario.task(TASK).fiducials + noise
        )

    def touch(self, points: np.ndarray) -> None:
        """Put touches (n, 3) float, World, mm into the scene, as the simulator sends them."""
        setPoints(Role.CAPTURED_POINTS.make(slicer.mrmlScene), LABELS[: len(points)], points)
        self.process()

    def child(self, name: str) -> Any:
        """Return a widget that came later than the `.ui` files."""
        return slicer.util.findChild(self._container, name)
