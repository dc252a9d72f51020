"""Scene and widgets for the module's self tests, which change no study and no setting."""

from __future__ import annotations

from typing import Any

import numpy as np
import slicer

from rastrainer import transforms
from rastrainer.scenario.points import LABELS
from rastrainer.slicer.scene.nodes import Role, setPoints

SCENARIO, TASK = "colin27", "task-1"
SEED, NOISE_MM = 3, 0.5


class SelfTestFixture:
    """The module's widgets and session, driven without a timer."""

    def __init__(self, widget: Any) -> None:
        self.session, self.ui = widget.logic.session, widget.ui
        self._container = widget.parent

    def process(self) -> None:
        """Do what the module's timers do, until nothing is left to be done."""
        self.session.process()
        while self.session.yieldTimeToWork():
            pass
        self.session.process()

    def showScenario(self) -> None:
        self.session.scenario.show(SCENARIO, TASK)
        self.process()

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
