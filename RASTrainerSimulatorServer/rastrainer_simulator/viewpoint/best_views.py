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
    """Finds the views of one trial's touches after another, in their order.

    Each is there as soon as it is found. What belongs to the head and the task is kept for the
    next trial, for it makes ticks late.
    """

    def __init__(self) -> None:
        self._found: dict[str, BestView] = {}
        self._lock = threading.Lock()
        self._views: tuple[SimulationSetup, TouchViews] | None = None

    def look(self, setup: SimulationSetup, task: str, head_to_world: np.ndarray) -> None:
        """Begin to look for those of a trial; HeadToWorld is the trial's, (4, 4) float, mm."""
        found: dict[str, BestView] = {}
        self._found = found
        threading.Thread(
            target=self._look,
            args=(setup, task, head_to_world, found),
            name="best views",
            daemon=True,
        ).start()

    def of(self, label: str | None) -> BestView | None:
        """Return the best view of a fiducial; None where it is not found yet, or there is none."""
        return None if label is None else self._found.get(label)

    def forget(self) -> None:
        """Look for no more."""
        self._found = {}

    def _look(
        self,
        setup: SimulationSetup,
        task: str,
        head_to_world: np.ndarray,
        found: dict[str, BestView],
    ) -> None:
        # Set aside while it holds the interpreter, it would make the control loop wait.
        raise_thread_priority()
        try:
            with self._lock:
                for label, view in self._views_of(setup).of(
                    setup.scenario.task(task), head_to_world
                ):
                    if self._found is not found:
                        return
                    if view is not None:
                        found[label] = view
        except (RASTrainerError, OSError):
            _log.exception("The best views of %s cannot be found", task)

    def _views_of(self, setup: SimulationSetup) -> TouchViews:
        if self._views is None or self._views[0] is not setup:
            self._views = setup, TouchViews(setup)
        return self._views[1]
