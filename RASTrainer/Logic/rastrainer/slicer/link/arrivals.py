"""Hands over what the simulator has sent: nodes that changed, and commands."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import DeviceName, decode_json_object
from rastrainer.slicer.scene.control_points import labelOf
from rastrainer.slicer.scene.link_nodes import (
    capturedPointsNode,
    decodedText,
    shownText,
    simStateNode,
)
from rastrainer.slicer.signal import ErrorGuard, Signal

MOST_KEPT = 256
"""Commands that wait; whoever sends more than can be handled is to send them again, as the
simulator does with trials and answers until they are acknowledged."""
COMMANDS_A_TURN, CHARACTERS_A_TURN = 16, 200_000
"""So much is handed over before the application may do something else."""


class Arrivals:
    """Reads what has arrived; what cannot be read is logged, and keeps nothing else back."""

    def __init__(
        self,
        scene: Any,
        guard: ErrorGuard,
        pointsChanged: Signal,
        stateChanged: Signal,
        commands: Mapping[str, Signal],
    ) -> None:
        """`commands` gives for the name of each known command which signal emits its content."""
        self._scene = scene
        self._guard = guard
        self._pointsChanged = pointsChanged
        self._stateChanged = stateChanged
        self._signals = commands
        self._commands: deque[tuple[str | bytes, str | bytes]] = deque()
        self._points: tuple = ()
        self._stateText: str | bytes = ""

    def keepCommand(self, name: str | bytes, content: str | bytes) -> None:
        """Keep a command until it can be handled; inside VTK, where nothing may raise.

        Where too many wait already, it is left out.
        """
        if len(self._commands) < MOST_KEPT:
            self._commands.append((name, content))

    def handOverNodes(self) -> None:
        """Tell of points and state that are not those of the last call."""
        self._guard.run("The touched points", self._handOverPoints)
        self._guard.run("The simulator's state", self._handOverState)

    def handOverCommands(self) -> None:
        """Tell of the commands that were kept, in their order; of many, the rest comes later."""
        characters = 0
        for _turn in range(min(len(self._commands), COMMANDS_A_TURN)):
            if characters > CHARACTERS_A_TURN:
                break
            name, content = self._commands.popleft()
            characters += len(content)
            name = shownText(name)
            if name in self._signals:
                self._handOver(content, name, self._signals[name])
            else:
                logging.warning("The simulator sent the unknown command %.40s.", name)

    def _handOverPoints(self) -> None:
        node = capturedPointsNode(self._scene)
        points = _snapshot(node)
        if points != self._points:
            self._points = points
            self._guard.emit("The touched points", self._pointsChanged, node)

    def _handOverState(self) -> None:
        text = simStateNode(self._scene).GetText()
        if text and text != self._stateText:
            self._stateText = text
            self._handOver(text, DeviceName.SIM_STATE, self._stateChanged)

    def _handOver(self, text: str | bytes, name: str, signal: Signal) -> None:
        try:
            value = decode_json_object(decodedText(text))
        except InputError as error:
            logging.error("What came as %s cannot be read: %s", name, error)
            return
        self._guard.emit(name, signal, value)


def _snapshot(markupsNode: Any) -> tuple:
    return tuple(
        (labelOf(markupsNode, i), tuple(markupsNode.GetNthControlPointPosition(i)))
        for i in range(markupsNode.GetNumberOfControlPoints())
    )
