"""What clients are told without asking: each device at its rate, packed once for all of them."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterable
from typing import Any

from rastrainer.igtl.message import Message
from rastrainer.protocol import Rate
from rastrainer_simulator.igtl import devices
from rastrainer_simulator.igtl.connection import Connection
from rastrainer_simulator.igtl.outgoing import Outgoing
from rastrainer_simulator.igtl.pacer import Pacer
from rastrainer_simulator.state import SimulationState, TrainingState


class Publisher:
    """Sends the simulation's state to its subscribers, at rates of simulated time.

    `is_due` may be called in the control loop's thread; everything else belongs to the event
    loop's.
    """

    def __init__(self, latest: Callable[[], SimulationState]):
        """`latest` gives the newest state, for those who subscribe between two publications."""
        self._latest = latest
        self._tool_tip: dict[Connection, Pacer] = {}
        self._links: dict[Connection, Pacer] = {}
        self._state = Pacer(Rate.STATE_HZ)
        self._numbers = itertools.count(1)
        self._told: dict[str, Any] = {}
        self._told_training: TrainingState | None = None
        self._next = math.inf

    def subscribe(
        self,
        connection: Connection,
        tool_tip_hz: float = Rate.TOOL_TIP_HZ,
        links_hz: float = Rate.LINKS_HZ,
    ) -> None:
        """Tell a client how things stand, and from now on what changes; again for other rates."""
        self._tool_tip[connection] = Pacer(tool_tip_hz)
        self._links[connection] = Pacer(links_hz)
        state = self._latest()
        self._send([connection], devices.captured_points(state.training))
        changing = devices.what_changes(state)
        self._send([connection], devices.sim_state(changing, state, next(self._numbers)))
        self._next = -math.inf

    def unsubscribe(self, connection: Connection) -> None:
        """Tell a client nothing more."""
        self._tool_tip.pop(connection, None)
        self._links.pop(connection, None)

    def is_due(self, state: SimulationState) -> bool:
        """Return whether `publish` would have something to send."""
        is_news = state.training is not self._told_training
        return bool(self._tool_tip) and (is_news or state.sim_time >= self._next)

    def publish(self, state: SimulationState) -> None:
        """Send whatever is due to whom it is due."""
        now = state.sim_time
        everyone = tuple(self._tool_tip)
        if state.training is not self._told_training:
            self._publish_training(everyone, state.training)
        if self._state.is_due(now):
            self._publish_state(everyone, state)
        tool_tip_due = [who for who, pacer in self._tool_tip.items() if pacer.is_due(now)]
        if tool_tip_due:
            self._send(tool_tip_due, devices.tool_tip(state, next(self._numbers)))
        links_due = [who for who, pacer in self._links.items() if pacer.is_due(now)]
        if links_due:
            self._send(links_due, *devices.links(state, next(self._numbers)))
        pacers = (self._state, *self._tool_tip.values(), *self._links.values())
        self._next = min(pacer.next for pacer in pacers)

    def _publish_training(self, everyone: Iterable[Connection], training: TrainingState) -> None:
        """Send the touched points whenever one was touched or taken back, and with a new trial."""
        told = self._told_training
        self._told_training = training
        if told is None or (told.touches, told.trial_id) != (training.touches, training.trial_id):
            self._send(everyone, devices.captured_points(training))

    def _publish_state(self, everyone: Iterable[Connection], state: SimulationState) -> None:
        changing = devices.what_changes(state)
        if changing != self._told:
            self._told = changing
            message = devices.sim_state(changing, state, next(self._numbers))
            self._send(everyone, message)

    def _send(self, receivers: Iterable[Connection], *messages: Message) -> None:
        for message in messages:
            outgoing = Outgoing(message)
            for connection in receivers:
                connection.send_latest(outgoing)
