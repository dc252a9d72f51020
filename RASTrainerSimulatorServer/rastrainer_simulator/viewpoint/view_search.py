"""The search for the best views of a trial, while the control loop runs."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import RASTrainerError
from rastrainer.scenario.points import Task
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.timing import raise_thread_priority
from rastrainer_simulator.viewpoint.best_view import BestView, TouchViews

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class _ViewedTrial:
    setup: SimulationSetup
    task: Task
    head_to_world: np.ndarray


class BestViews:
    """Finds the views of one trial's touches, in a thread.

    Results for the head and the task are kept for the next trial, as computing them makes ticks
    late.
    """

    def __init__(self) -> None:
        # Set aside while it holds the interpreter, it would make the control loop wait.
        self._worker = ThreadPoolExecutor(1, "best views", raise_thread_priority)
        self._trial: _ViewedTrial | None = None
        self._views: tuple[_ViewedTrial, TouchViews] | None = None

    def look(self, setup: SimulationSetup, task: str, head_to_world: np.ndarray) -> None:
        """Prepare the searches of a trial; HeadToWorld is the trial's, (4, 4) float, mm."""
        trial = self._trial = _ViewedTrial(setup, setup.scenario.task(task), head_to_world)
        for label in trial.task.labels:
            self._worker.submit(self._find, trial, label)

    def search(self, label: str, q: Sequence[float]) -> Future[BestView | None]:
        """Look for the best view of a fiducial while the arm has joint angles `q`, rad."""
        return self._worker.submit(self._find, self._trial, label, q)

    def forget(self) -> None:
        self._trial = None

    def _find(
        self, trial: _ViewedTrial | None, label: str, q: Sequence[float] | None = None
    ) -> BestView | None:
        """Return the best view; without a posture only what does not depend on it is computed."""
        if trial is None or trial is not self._trial:
            return None
        try:
            known = self._views
            is_same_robot = known is not None and known[0].setup is trial.setup
            views = known[1] if known is not None and is_same_robot else TouchViews(trial.setup)
            if known is None or known[0] is not trial:
                views.begin(trial.task, trial.head_to_world)
                self._views = trial, views
            views.views(label)
        except (RASTrainerError, OSError):
            _log.exception("The best views of %s cannot be found", trial.task.name)
            return None
        return None if q is None else views.best(label, q)
