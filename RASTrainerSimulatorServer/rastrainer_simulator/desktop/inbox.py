"""What the simulator has said last, between the connection that fills it and the picture."""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer_simulator.desktop.flight import Viewpoint
from rastrainer_simulator.desktop.glb_parts import Part
from rastrainer_simulator.flow.screen import Screen


@dataclass(frozen=True)
class SceneNews:
    """A scene to be shown, its cameras by name, and its fiducials in the head's frame (m)."""

    parts: list[Part]
    cameras: Mapping[str, Viewpoint]
    fiducials: Mapping[str, tuple[float, float, float]]


@dataclass(frozen=True)
class SoundEvent:
    """A sound to be played once."""

    name: str
    volume: float


class Inbox:
    """The latest of everything; only sounds wait for each other.

    Attributes:
        state: members of the latest `state` message; None before the first.
        states: how many have come.
        screen: what the trainee reads; None before the first.
        scene: None until one has been loaded.
        sounds: those not played yet.
        problem: key of the text that says why there is no connection; "" while there is one.
    """

    def __init__(self) -> None:
        self.state: Mapping[str, Any] | None = None
        self.states = 0
        self.screen: Screen | None = None
        self.scene: SceneNews | None = None
        self.sounds: deque[SoundEvent] = deque(maxlen=16)
        self.problem = "window.connecting"
        self._has_changed = asyncio.Event()

    def take_state(self, state: Mapping[str, Any]) -> None:
        """Replace the state."""
        self.state = state
        self.states += 1
        self.touch()

    def touch(self) -> None:
        """Wake whoever waits for news."""
        self._has_changed.set()

    async def wait(self, timeout: float) -> None:
        """Wait for news, but at most `timeout` seconds."""
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._has_changed.wait(), timeout)
        self._has_changed.clear()
