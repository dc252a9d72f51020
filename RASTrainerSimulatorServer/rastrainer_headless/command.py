"""A stand-in of `vtkSlicerOpenIGTLinkCommand`: one sent command, and its answer."""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from dataclasses import dataclass

import vtk

from rastrainer.igtl.content import ERROR_KEY, STATUS_KEY, SUCCESS
from rastrainer_headless.peer_sockets import recordCrash

WireText = str | bytes
"""Python gets a text of VTK's as `bytes` if it is not UTF-8."""


class HeadlessCommand(vtk.vtkObject):
    """The part of the real class that we use, with its names, values and default time-out."""

    (
        CommandUnknown,
        CommandWaiting,
        CommandExpired,
        CommandCancelled,
        CommandFailed,
        CommandResponseReceived,
        CommandResponseSent,
    ) = range(7)

    CommandResponseEvent = 128000
    CommandExpiredEvent = 128001
    CommandReceivedEvent = 128002
    CommandCancelledEvent = 128003
    CommandCompletedEvent = 128004

    def __init__(self) -> None:
        self.commandId = -1
        self._name: WireText = ""
        self._content: WireText = ""
        self._response: WireText = ""
        self._responseMetaData: Mapping[str, WireText] = {}
        self._timeoutSec = 5.0
        self._status = self.CommandUnknown

    def SetName(self, name: WireText) -> None:
        self._name = name

    def GetName(self) -> WireText:
        return self._name

    def SetCommandContent(self, content: WireText) -> None:
        self._content = content

    def GetCommandContent(self) -> WireText:
        return self._content

    def SetTimeoutSec(self, seconds: float) -> None:
        """Set how long to wait for an answer."""
        self._timeoutSec = seconds

    def GetTimeoutSec(self) -> float:
        """Return how long to wait for an answer, in seconds."""
        return self._timeoutSec

    def GetCommandStatus(self) -> int:
        """Return one of the constants above."""
        return self._status

    def SetCommandStatus(self, status: int) -> None:
        """Set one of the constants above."""
        self._status = status

    def IsInProgress(self) -> bool:
        """Return whether the command was sent and neither answered nor given up."""
        return self._status == self.CommandWaiting

    def IsCompleted(self) -> bool:
        """Return whether the command was answered or given up; False for one never sent."""
        return self._status not in (self.CommandUnknown, self.CommandWaiting)

    def setResponse(self, content: WireText, metaData: Mapping[str, WireText]) -> None:
        """Keep the answer (the connector's part)."""
        self._response = content
        self._responseMetaData = metaData
        self._status = self.CommandResponseReceived

    def GetResponseContent(self) -> WireText:
        """Return the body of the answer."""
        return self._response

    def GetResponseMetaDataElement(self, key: str) -> WireText:
        """Return one entry of the answer's metadata, empty if there is none."""
        return self._responseMetaData.get(key, "")

    def GetSuccessful(self) -> bool:
        """Return whether the answer says SUCCESS in its metadata; its content does not matter."""
        return self.GetResponseMetaDataElement(STATUS_KEY) == SUCCESS

    def GetErrorMessage(self) -> WireText:
        """Return the sentence that came with a refusal."""
        return self.GetResponseMetaDataElement(ERROR_KEY)


@dataclass(frozen=True)
class OutgoingCommand:
    """A sent command.

    The real connector keeps what a command says, and reports its events to the object that was made
    in Python, whether or not that still lives.
    """

    commandId: int
    deadline: float
    command: weakref.ref[HeadlessCommand]

    def alive(self) -> HeadlessCommand:
        """Return the command; without it Slicer would crash."""
        command = self.command()
        if command is None:
            raise recordCrash("A command was deleted before the connector was done with it.")
        return command
