"""Plays a film to the views; it stands where the control loop stands while a trial is played."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable
from dataclasses import replace

from rastrainer_simulator.loop_statistics import LoopStatistics
from rastrainer_simulator.replaying.film import Film
from rastrainer_simulator.setup import SimulationSetup
from rastrainer_simulator.state import SimulationState, StepResult
from rastrainer_simulator.subscribers import Subscribers

PERIOD_S = 1.0 / 60.0


class ReplayLoop:
    """Shows one frame after the other, in the event loop's thread.

    Attributes:
        film: what is played.
        setup: head and robot.
        time_s: where in the film it is.
        is_playing: whether it goes on.
        until_s: where it stops by itself.
        speed: film's seconds in a second.
        latest: the state that is shown.
        changed: is called whenever any of this has changed.
    """

    statistics = LoopStatistics()

    def __init__(self, film: Film, setup: SimulationSetup) -> None:
        self.film = film
        self.setup = setup
        self.time_s = 0.0
        self.is_playing = True
        self.until_s = film.duration_s
        self.speed = 1.0
        self.latest: SimulationState = film.frames[0].state
        self.changed: Callable[[], None] = lambda: None
        self._camera: str | None = None
        self._subscribers: Subscribers[StepResult] = Subscribers()
        self._shown = -1

    def subscribe(self, callback: Callable[[StepResult], None]) -> Callable[[], None]:
        """Have `callback` called with each frame; returns what ends that."""
        return self._subscribers.add(callback)

    def play_from(self, time_s: float, until_s: float | None = None, speed: float = 1.0) -> None:
        """Go on from a time in s, up to another or the end."""
        self.time_s = min(max(0.0, time_s), self.film.duration_s)
        end_s = self.film.duration_s
        self.until_s = end_s if until_s is None else min(until_s, end_s)
        self.speed, self.is_playing = speed, True
        self._show(is_jump=True)

    def pause(self, is_paused: bool) -> None:
        """Stand still or go on; at the end, it goes on from the beginning."""
        if not is_paused and self.time_s >= self.until_s:
            at_end = self.time_s >= self.film.duration_s
            self.play_from(0.0 if at_end else self.time_s)
        self.is_playing = not is_paused
        self.changed()

    def look(self, camera: str) -> None:
        """Look through another camera than the trainee did, from now on."""
        self._camera = camera
        self._show(is_jump=True)

    def advance(self, seconds: float) -> None:
        """Let so much of the wall's time pass."""
        if not self.is_playing:
            # Views that have just joined are told where it stands.
            self._tell(())
            return
        self.time_s = min(self.time_s + seconds * self.speed, self.until_s)
        if self.time_s >= self.until_s:
            self.is_playing = False
        self._show(is_jump=False)

    async def run(self) -> None:
        """Play until it is canceled."""
        before = time.monotonic()
        while True:
            await asyncio.sleep(PERIOD_S)
            now = time.monotonic()
            self.advance(now - before)
            before = now

    def _show(self, is_jump: bool) -> None:
        frame = self.film.frames.number_at(self.time_s)
        passed = () if is_jump else self.film.frames[self._shown + 1 : frame + 1]
        self._shown = frame
        self.latest = self.film.frames[frame].state
        if self._camera is not None:
            self.latest = replace(self.latest, camera=self._camera)
        self._tell(tuple(event for one in passed for event in one.events))
        self.changed()

    def _tell(self, events: tuple) -> None:
        result = StepResult(self.latest, events)
        self._subscribers.tell(result)
