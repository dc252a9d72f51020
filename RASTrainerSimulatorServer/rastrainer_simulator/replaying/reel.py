"""The frames of a film, packed: a trial has thousands of them, each of dozens of objects."""

from __future__ import annotations

import bisect
import pickle
from array import array
from collections.abc import Sequence
from dataclasses import dataclass
from typing import overload

from rastrainer_simulator.state import Event, SimulationState

FRAMES_A_BLOCK = 12
"""So few that unpacking a block takes no longer than a tick of the control loop."""


@dataclass(frozen=True)
class Frame:
    """What is shown at a moment.

    Attributes:
        time_s: from the trial's start, with its pauses.
        state: of the simulation.
        events: what has happened since the frame before.
    """

    time_s: float
    state: SimulationState
    events: tuple[Event, ...]


class Reel(Sequence[Frame]):
    """Frames in their order; about 2 kB each.

    As objects they would make every garbage collection in the control loop's process late, and
    their release, too.
    """

    def __init__(self) -> None:
        self._times = array("d")
        self._blocks: list[bytes] = []
        self._last: list[Frame] = []
        self._unpacked: tuple[int, list[Frame]] = (-1, [])

    def add(self, frame: Frame) -> None:
        """Put a frame behind the last."""
        self._times.append(frame.time_s)
        self._last.append(frame)
        if len(self._last) == FRAMES_A_BLOCK:
            self._blocks.append(pickle.dumps(self._last, pickle.HIGHEST_PROTOCOL))
            self._last = []

    def number_at(self, time_s: float) -> int:
        """Return the number of the frame that is shown at a time."""
        return max(0, bisect.bisect_right(self._times, time_s) - 1)

    def __len__(self) -> int:
        return len(self._times)

    @overload
    def __getitem__(self, index: int) -> Frame: ...

    @overload
    def __getitem__(self, index: slice) -> tuple[Frame, ...]: ...

    def __getitem__(self, index: int | slice) -> Frame | tuple[Frame, ...]:
        numbers = range(len(self))[index]
        if isinstance(numbers, int):
            return self._frame(numbers)
        return tuple(map(self._frame, numbers))

    def _frame(self, number: int) -> Frame:
        block, place = divmod(number, FRAMES_A_BLOCK)
        if block == len(self._blocks):
            return self._last[place]
        if block != self._unpacked[0]:
            # Packed by ourselves, in this process or in the one that made the film.
            self._unpacked = block, pickle.loads(self._blocks[block])
        return self._unpacked[1][place]
