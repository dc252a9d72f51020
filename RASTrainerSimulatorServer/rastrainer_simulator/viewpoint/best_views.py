"""The best views of a trial's touches, looked for in a thread beside the control loop."""

from __future__ import annotations

import logging
import threading

import numpy as np

from rastrainer.errors import RASTrainerError
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.precise_clock import raise_thread_priority
from rastrainer_simulator.viewpoint.best_view import BestView
from rastrainer_simulator.viewpoint.touch_views import TouchViews

_log = logging.getLogger(__name__)


class BestViews:
    """Finds the views of one trial's touches, in their order.

    Each is there as soon as it is found; the thread ends with the last.
    """

    def __init__(self, setup: SimulationSetup, task: str, head_to_world: np.ndarray) -> None:
        """Begin to look; HeadToWorld is the trial's, (4, 4) float, mm."""
        self._setup = setup
        self._task = task
        self._head_to_world = head_to_world
        self._found: dict[str, BestView] = {}
        self._is_over = False
        threading.Thread(target=self._look, name="best views", daemon=True).start()

    def of(self, label: str | None) -> BestView | None:
        """Return the best view of a fiducial; None where it is not found yet, or there is none."""
        return None if label is None else self._found.get(label)

    def end(self) -> None:
        """Look for no more."""
        self._is_over = True

    def _look(self) -> None:
        # Set aside while it holds the interpreter, it would make the control loop wait.
        raise_thread_priority()
        try:
            scenario = self._setup.scenario
            views = TouchViews(self._setup).of(scenario.task(self._task), self._head_to_world)
            for label, view in views:
                if self._is_over:
                    return
                if view is not None:
                    self._found[label] = view
        except (RASTrainerError, OSError):
            _log.exception("The best views of %s cannot be found", self._task)
