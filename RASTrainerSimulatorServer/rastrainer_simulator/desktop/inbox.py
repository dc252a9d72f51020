"""What the simulator has said last, between the connection that fills it and the picture."""

from __future__ import annotations

import asyncio
import contextlib
import logging
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rastrainer.finite_json import decode_finite_json
from rastrainer_simulator.desktop.camera import Viewpoint
from rastrainer_simulator.desktop.glb_parts import Part
from rastrainer_simulator.desktop.panels.sprite import Thumbnail
from rastrainer_simulator.desktop.shown_trace import ShownTrace
from rastrainer_simulator.net.views.screen import Screen

STATE_MEMBERS = (
    "ghost",
    "tick",
    "phase",
    "touch",
    "clearanceMm",
    "camera",
    "view",
    "inset",
    "next",
    "touched",
    "procedure",
)

_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class LoadedScene:
    """A scene to be shown, its cameras by name, and its fiducials in the head's frame (m).

    `no_go` names the nodes of the no-go structures of each procedure.
    """

    parts: list[Part]
    cameras: Mapping[str, Viewpoint]
    fiducials: Mapping[str, tuple[float, float, float]]
    no_go: Mapping[str, tuple[str, ...]] = field(default_factory=dict)


@dataclass(frozen=True)
class SoundEvent:
    """A sound to be played once."""

    name: str
    volume: float


class Inbox:
    """The latest of everything; only sounds wait for each other.

    Attributes:
        state: members of the latest `state` message, as of the last `read_state`; None before.
        holder: what drives the arm; "" while nobody does.
        has_control: whether it is this window's keys or mouse.
        pairing: code and addresses by which other views are paired; None while unknown.
        bodies: names in the order of a state's poses.
        thumbnails: pictures of the menus' items by where they come from.
        screen: what the trainee reads; None before the first.
        trace: what was traced over the skin, and where to draw next.
        scene: None until one has been loaded.
        sounds: those not played yet.
        problem: key of the text that says why there is no connection; "" while there is one.
    """

    def __init__(self) -> None:
        self.state: Mapping[str, Any] | None = None
        self._unread: str | None = None
        self.screen: Screen | None = None
        self.trace = ShownTrace()
        self.scene: LoadedScene | None = None
        self.sounds: deque[SoundEvent] = deque(maxlen=16)
        self.problem = "window.connecting"
        self.holder = ""
        self.has_control = False
        self.pairing: tuple[str, str] | None = None
        self.bodies: tuple[str, ...] = ()
        self.thumbnails: dict[str, Thumbnail] = {}
        self._has_changed = asyncio.Event()

    def take_state(self, text: str) -> None:
        """Replace the state by a message, which nobody reads before it is to be drawn.

        So a window that draws slowly still keeps up with what is sent 60 times a second.
        """
        self._unread = text
        self.touch()

    def read_state(self) -> None:
        """Read the latest message; one that is no state changes nothing."""
        text, self._unread = self._unread, None
        if text is None:
            return
        try:
            members = decode_finite_json(text)
            poses = dict(zip(self.bodies, members["poses"], strict=True))
            self.state = {name: members[name] for name in STATE_MEMBERS} | {"poses": poses}
        except (KeyError, TypeError, ValueError) as error:
            _log.warning("A state of the simulator cannot be used: %s", error)

    def touch(self) -> None:
        """Wake the thread that waits for news."""
        self._has_changed.set()

    async def wait(self, timeout: float) -> None:
        """Wait for news, but at most `timeout` seconds."""
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._has_changed.wait(), timeout)
        self._has_changed.clear()
