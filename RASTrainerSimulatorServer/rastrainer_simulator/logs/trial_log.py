"""A line in the log whenever a trial changes its phase."""

from __future__ import annotations

import asyncio
import logging

from rastrainer_simulator.state import EventKind, StepResult, TrainingState

_log = logging.getLogger(__name__)


class TrialLog:
    """Subscribes to a control loop; files are written in the event loop's thread only."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop

    def __call__(self, result: StepResult) -> None:
        """Take a tick; called in the control loop's thread."""
        if any(event.kind is EventKind.PHASE for event in result.events):
            self._loop.call_soon_threadsafe(_note, result.state.training)


def _note(training: TrainingState) -> None:
    data = {
        "trialId": training.trial_id,
        "task": training.task,
        "mode": training.mode,
        "points": len(training.touches),
    }
    _log.info("The trial is %s.", training.phase.value, extra={"data": data})
