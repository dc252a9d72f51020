"""Sources of the states that views show: the live arm, or recorded trials."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import Callable
from dataclasses import replace

from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.loop.results import Subscribers
from rastrainer_simulator.loop.timing import LoopStatistics
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.state import SimulationState, StepResult

PERIOD_S = 1.0 / 60.0


class Playback:
    """Plays a recorded trial, in the event loop's thread.

    `speed` is in seconds of the trial per second; `changed` is called whenever any of this has.
    """

    statistics = LoopStatistics()

    def __init__(self, trial: RecordedTrial, setup: SimulationSetup) -> None:
        self.trial = trial
        self.setup = setup
        self.time_s = 0.0
        self.is_playing = True
        self.until_s = trial.duration_s
        self.speed = 1.0
        self.latest: SimulationState = trial.state_at(0.0)
        self.changed: Callable[[], None] = lambda: None
        self._camera: str | None = None
        self._subscribers: Subscribers[StepResult] = Subscribers()
        self.subscribe = self._subscribers.add
        self._shown_s = -math.inf

    def play_from(self, time_s: float, until_s: float | None = None, speed: float = 1.0) -> None:
        self.time_s = min(max(0.0, time_s), self.trial.duration_s)
        end_s = self.trial.duration_s
        self.until_s = end_s if until_s is None else min(until_s, end_s)
        self.speed, self.is_playing = speed, True
        self._show(is_jump=True)

    def pause(self, is_paused: bool) -> None:
        """Pause or resume; at the end, resume from the beginning."""
        if not is_paused and self.time_s >= self.until_s:
            at_end = self.time_s >= self.trial.duration_s
            self.play_from(0.0 if at_end else self.time_s)
        self.is_playing = not is_paused
        self.changed()

    def use_camera(self, camera: str) -> None:
        self._camera = camera
        self._show(is_jump=True)

    def advance(self, seconds: float) -> None:
        if not self.is_playing:
            # For views that have just joined.
            self._subscribers.publish(StepResult(self.latest, ()))
            return
        self.time_s = min(self.time_s + seconds * self.speed, self.until_s)
        if self.time_s >= self.until_s:
            self.is_playing = False
        self._show(is_jump=False)

    def _show(self, is_jump: bool) -> None:
        events = () if is_jump else self.trial.events_between(self._shown_s, self.time_s)
        self._shown_s = self.time_s
        self.latest = self.trial.state_at(self.time_s)
        if self._camera is not None:
            self.latest = replace(self.latest, camera=self._camera)
        self._subscribers.publish(StepResult(self.latest, events))
        self.changed()


async def play_on(advance: Callable[[float], None]) -> None:
    """Call `advance` with the s that have gone by, until it is canceled."""
    before = time.monotonic()
    while True:
        await asyncio.sleep(PERIOD_S)
        now = time.monotonic()
        advance(now - before)
        before = now


class PlaybackSwitch:
    """A `StateSource` that passes on the states of another source, or of a playback.

    The other, such as the control loop, runs on unchanged. Subscribers are called in its or the
    playback's thread.

    `alter` changes a state of the other before it is shown, in any thread, if it is not None;
    `playback` is the playback that is shown, None for the other source.
    """

    def __init__(self, source: ControlLoop | Playback) -> None:
        self.alter: Callable[[SimulationState], SimulationState] | None = None
        self.playback: Playback | None = None
        self._source = source
        self.statistics = source.statistics
        self._subscribers: Subscribers[StepResult] = Subscribers()
        self.subscribe = self._subscribers.add
        self._end_playback: Callable[[], None] = lambda: None
        self._unsubscribe = source.subscribe(self._take_tick)

    @property
    def latest(self) -> SimulationState:
        if self.playback is not None:
            return self.playback.latest
        alter, now = self.alter, self._source.latest
        return now if alter is None else alter(now)

    @property
    def setup(self) -> SimulationSetup:
        return (self.playback or self._source).setup

    def show(self, playback: Playback | None) -> None:
        """Show a playback from now on, or the other source for None."""
        if playback is self.playback:
            return
        self._end_playback()
        self.playback = playback
        if playback is not None:
            self._end_playback = playback.subscribe(self._subscribers.publish)

    def close(self) -> None:
        self.show(None)
        self._unsubscribe()

    def _take_tick(self, result: StepResult) -> None:
        if self.playback is None:
            alter = self.alter
            shown = result if alter is None else replace(result, state=alter(result.state))
            self._subscribers.publish(shown)
