"""The ghost of the present trial: an earlier trial that moves beside the arm."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from rastrainer.protocol import GhostRule, Phase
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.replay.ghost import Ghost, GhostLoading
from rastrainer_simulator.state import SimulationState

_SHOWN = (Phase.RUNNING, Phase.PAUSED)


class TrialGhost:
    """Loads the ghost of a trial, and shows it by the trial's time.

    Attributes:
        rule: which trial it is; `GhostRule.OFF` until one is shown.
    """

    def __init__(self) -> None:
        self.rule = GhostRule.OFF
        self._wanted = GhostRule.OFF
        self._trial_id = ""
        self._loading: GhostLoading | None = None
        self._ghost: Ghost | None = None

    def begin(
        self,
        rule: GhostRule,
        journals: Sequence[Path],
        trial_id: str,
        setup: SimulationSetup,
        head_to_world: np.ndarray,
    ) -> None:
        """Begin to load the first usable journal for a trial; HeadToWorld as of a `Ghost`."""
        self.close()
        self._wanted, self._trial_id = rule, trial_id
        if rule is not GhostRule.OFF:
            self._loading = GhostLoading(journals, setup, head_to_world)

    def close(self) -> None:
        """Show none."""
        if self._loading is not None:
            self._loading.cancel()
        self._loading = self._ghost = None
        self.rule = GhostRule.OFF

    def has_just_loaded(self) -> bool:
        """Return whether loading has just ended, true once; `rule` says whether there is one."""
        if self._loading is None or not self._loading.ghost.done():
            return False
        self._ghost, self._loading = self._loading.ghost.result(), None
        if self._ghost is not None:
            self.rule = self._wanted
        return True

    def poses(self, now: SimulationState) -> tuple[np.ndarray, ...] | None:
        """Return the ghost's poses, as of a `Ghost`; None where none is to be seen."""
        training = now.training
        if self._ghost is None or training.trial_id != self._trial_id:
            return None
        return self._ghost.poses(now.elapsed) if training.phase in _SHOWN else None
