"""Emits what the simulator has sent: nodes that changed, and commands."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import DeviceName, decode_told_object
from rastrainer.slicer.scene.control_points import labelOf
from rastrainer.slicer.scene.link_nodes import (
    capturedPointsNode,
    decodedText,
    shownText,
    simStateNode,
)
from rastrainer.slicer.signal import ErrorGuard, Signal

MAX_KEPT = 256
"""Most commands that wait. A sender of more has to repeat them, as the simulator does with trials
and answers until they are acknowledged."""
COMMANDS_A_TURN, CHARACTERS_A_TURN = 16, 200_000
"""What is processed before the application may do something else."""


class Arrivals:
    """Reads what has arrived; what cannot be read is logged and does not stop the rest."""

    def __init__(
        self,
        scene: Any,
        guard: ErrorGuard,
        pointsChanged: Signal,
        stateChanged: Signal,
        commands: Mapping[str, Signal],
    ) -> None:
        """`commands` maps the name of each known command to the signal that emits its content."""
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

        It is dropped if too many wait already.
        """
        if len(self._commands) < MAX_KEPT:
            self._commands.append((name, content))

    def emitNodes(self) -> None:
        """Emit points and state that differ from those of the last call."""
        self._guard.run("The touched points", self._emitPoints)
        self._guard.run("The simulator's state", self._emitState)

    def emitCommands(self) -> None:
        """Emit the kept commands in their order; of many, the rest follows later."""
        characters = 0
        for _turn in range(min(len(self._commands), COMMANDS_A_TURN)):
            if characters > CHARACTERS_A_TURN:
                break
            name, content = self._commands.popleft()
            characters += len(content)
            name = shownText(name)
            if name in self._signals:
                self._emitContent(content, name, self._signals[name])
            else:
                logging.warning("The simulator sent the unknown command %.40s.", name)

    def _emitPoints(self) -> None:
        node = capturedPointsNode(self._scene)
        points = _snapshot(node)
        if points != self._points:
            self._points = points
            self._guard.emit("The touched points", self._pointsChanged, node)

    def _emitState(self) -> None:
        text = simStateNode(self._scene).GetText()
        if text and text != self._stateText:
            self._stateText = text
            self._emitContent(text, DeviceName.SIM_STATE, self._stateChanged)

    def _emitContent(self, text: str | bytes, name: str, signal: Signal) -> None:
        try:
            value = decode_told_object(decodedText(text))
        except InputError as error:
            logging.error("What came as %s cannot be read: %s", name, error)
            return
        self._guard.emit(name, signal, value)


def _snapshot(markupsNode: Any) -> tuple:
    return tuple(
        (labelOf(markupsNode, i), tuple(markupsNode.GetNthControlPointPosition(i)))
        for i in range(markupsNode.GetNumberOfControlPoints())
    )
