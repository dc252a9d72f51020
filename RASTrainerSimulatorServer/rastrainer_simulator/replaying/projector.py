"""What the views show: the arm as it is, or a trial that is shown again."""

from __future__ import annotations

from collections.abc import Callable

from rastrainer_simulator.control_loop import ControlLoop
from rastrainer_simulator.loop_statistics import LoopStatistics
from rastrainer_simulator.replaying.replay_loop import ReplayLoop
from rastrainer_simulator.setup import SimulationSetup
from rastrainer_simulator.state import SimulationState, StepResult
from rastrainer_simulator.subscribers import Subscribers


class Projector:
    """A `StateSource` that passes on the control loop's states, or a film's while one is shown.

    It changes nothing of the control loop, which goes on.
    """

    def __init__(self, control_loop: ControlLoop) -> None:
        self._control_loop = control_loop
        self._replay: ReplayLoop | None = None
        self._subscribers: Subscribers[StepResult] = Subscribers()
        self._end_replay: Callable[[], None] = lambda: None
        self._unsubscribe = control_loop.subscribe(self._take_tick)

    @property
    def latest(self) -> SimulationState:
        """The state that is shown."""
        return (self._replay or self._control_loop).latest

    @property
    def setup(self) -> SimulationSetup:
        """What the present simulation was made from."""
        return self._control_loop.setup

    @property
    def statistics(self) -> LoopStatistics:
        """How punctual the control loop has been."""
        return self._control_loop.statistics

    def subscribe(self, callback: Callable[[StepResult], None]) -> Callable[[], None]:
        """Have `callback` called with what is shown; returns what ends that.

        It is called in the control loop's thread or in that of the film, and must return at once.
        """
        return self._subscribers.add(callback)

    def show(self, replay: ReplayLoop | None) -> None:
        """Show a film from now on, or with None the arm as it is."""
        if replay is self._replay:
            return
        self._end_replay()
        self._replay = replay
        if replay is not None:
            self._end_replay = replay.subscribe(self._subscribers.tell)

    def close(self) -> None:
        """Let go of the control loop."""
        self.show(None)
        self._unsubscribe()

    def _take_tick(self, result: StepResult) -> None:
        if self._replay is None:
            self._subscribers.tell(result)
