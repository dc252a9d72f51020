"""An earlier trial of the same task as a ghost: where its tool was, as the head stands now."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.journal.recording import ReplayTrack, read_track
from rastrainer.protocol import GhostRule, Phase
from rastrainer_simulator.core.interrupted_trial import seed_of
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.net.views.outgoing import GHOST_LINKS
from rastrainer_simulator.replay.recorded_trial import JournalLoading
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.state import SimulationState

AFTER_S = 0.5
"""How long after its last touch a ghost stays."""


class Ghost:
    """The last link and the tool of a recorded trial.

    The head stands differently in each trial, and what counts is the path of the tip on the head:
    all poses are moved as the head is. The base of the arm does not move with the head, so the
    links before the last are left out.
    """

    def __init__(self, track: ReplayTrack, setup: SimulationSetup, head_to_world: np.ndarray):
        """Prepare for the HeadToWorld of the present trial, (4, 4) float, mm."""
        header, touches = track.header, track.trajectory.touches
        other = setup.difference(header)
        if other in ("scenario", "robot") or not touches:
            raise InputError("The trial cannot be a ghost: it has another head, or no touch.")
        then = setup.scenario.perturbed_head_to_world(seed_of(header))
        self._moved = transforms.in_meters(head_to_world @ np.linalg.inv(then))
        self._track = track
        self._kinematics = make_kinematics(setup.robot)
        self._links = tuple(setup.robot.moving_links[joint].name for joint in GHOST_LINKS)
        self._tip = setup.robot.tip.name
        self.duration_s = touches[-1].time_s + AFTER_S

    def poses(self, time_s: float) -> tuple[np.ndarray, ...] | None:
        """Return the last link and the tool at a time since the start; None after the end.

        Each is (4, 4) float, to World, m.
        """
        if time_s > self.duration_s:
            return None
        placed = self._kinematics.links(tuple(self._track.at(time_s, self._track.q).tolist()))
        return tuple(self._moved @ placed[name] for name in (*self._links, self._tip))


_SHOWN = (Phase.RUNNING, Phase.PAUSED)


class TrialGhost:
    """Loads the ghost of a trial by a `rule`, OFF until one is shown, and shows it by its time."""

    def __init__(self) -> None:
        self.rule = GhostRule.OFF
        self._wanted = GhostRule.OFF
        self._trial_id = ""
        self._loading: JournalLoading[Ghost | None] | None = None
        self._ghost: Ghost | None = None

    def begin(
        self,
        rule: GhostRule,
        journals: Sequence[Path],
        trial_id: str,
        setup: SimulationSetup,
        head_to_world: np.ndarray,
    ) -> None:
        """Start loading the first usable journal for a trial; HeadToWorld as of a `Ghost`."""
        self.close()
        self._wanted, self._trial_id = rule, trial_id

        def load(check: Callable[[], None]) -> Ghost | None:
            for journal in journals:
                # It has another head, is damaged or was deleted meanwhile: try the next best.
                with suppress(InputError, LookupError, TypeError, ValueError, AttributeError):
                    return Ghost(read_track(journal, check), setup, head_to_world)
            return None

        if rule is not GhostRule.OFF:
            self._loading = JournalLoading(load)

    def close(self) -> None:
        if self._loading is not None:
            self._loading.cancel()
        self._loading = self._ghost = None
        self.rule = GhostRule.OFF

    def has_just_loaded(self) -> bool:
        """Return whether loading has just ended, true once; `rule` says whether there is one."""
        if self._loading is None or not self._loading.loaded.done():
            return False
        self._ghost, self._loading = self._loading.loaded.result(), None
        if self._ghost is not None:
            self.rule = self._wanted
        return True

    def poses(self, now: SimulationState) -> tuple[np.ndarray, ...] | None:
        """Return the ghost's poses, as of a `Ghost`; None if none is to be seen."""
        training = now.training
        if self._ghost is None or training.trial_id != self._trial_id:
            return None
        return self._ghost.poses(now.elapsed) if training.phase in _SHOWN else None
