"""Teachers' boards that watch this seat: who trains, how far they are, and what is wrong."""

from __future__ import annotations

import dataclasses
import math

from rastrainer.protocol import OPEN_PHASES
from rastrainer_simulator.loop.rates import Pacer
from rastrainer_simulator.net.views import outgoing
from rastrainer_simulator.net.views.presenter import Seat
from rastrainer_simulator.net.views.view import View
from rastrainer_simulator.state import SimulationState

NEWS_HZ = 5.0
"""At most: a board has many seats."""


class Boards:
    """The joined boards; all are told the same, and only when it has changed."""

    def __init__(self) -> None:
        self._joined: dict[int, View] = {}
        self._told = ""
        self._pacer = Pacer(NEWS_HZ)

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self._joined)

    async def serve(self, board: View, now: SimulationState, seat: Seat) -> None:
        """Tell a board everything, and have it told what changes until it leaves."""
        # First the others: then all know the same, and the new one is told nothing twice.
        self.tell(now, seat)
        self._joined[board.number] = board
        try:
            board.outbox.put_latest(outgoing.WELCOME, outgoing.welcome(board.number))
            board.outbox.put_latest(outgoing.SEAT, self._told)
            await board.serve()
        finally:
            del self._joined[board.number]

    def is_due(self, time_s: float) -> bool:
        """Return whether anybody is to be told something now."""
        return bool(self._joined) and self._pacer.is_due(time_s)

    def tell(self, now: SimulationState, seat: Seat) -> None:
        """Tell all boards how the seat is, if that has changed."""
        text = seat_text(now, seat)
        if text != self._told:
            self._told = text
            for board in self._joined.values():
                board.outbox.put_latest(outgoing.SEAT, text)

    async def close(self, message: str) -> None:
        """Send them away because the simulator ends."""
        for board in tuple(self._joined.values()):
            await board.close(message)


def seat_text(now: SimulationState, seat: Seat) -> str:
    """Return all that a board is told of a seat, with the trial's clock in whole seconds."""
    training = now.training
    is_open = training.phase in OPEN_PHASES
    return outgoing.seat(
        **dataclasses.asdict(seat),
        phase=training.phase.value,
        touched=len(training.touches) if is_open else 0,
        rejected=training.rejected if is_open else 0,
        elapsed=math.floor(now.elapsed) if is_open else 0,
        touch=now.touch.value,
    )
