"""A stand-in of `vtkSlicerOpenIGTLinkCommand`: one sent command, and its answer."""

from __future__ import annotations

from collections.abc import Mapping

import vtk

from rastrainer.igtl.content import ERROR_KEY, STATUS_KEY, SUCCESS

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
    CommandCompletedEvent = 128004

    def __init__(self) -> None:
        self.commandId = -1
        self._name: WireText = ""
        self._content: WireText = ""
        self._response: WireText = ""
        self._metadata: Mapping[str, WireText] = {}
        self.timeoutSec = 5.0
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
        self.timeoutSec = seconds

    def GetCommandStatus(self) -> int:
        return self._status

    def SetCommandStatus(self, status: int) -> None:
        self._status = status

    def IsInProgress(self) -> bool:
        """Return whether the command was sent and neither answered nor given up."""
        return self._status == self.CommandWaiting

    def setResponse(self, content: WireText, metadata: Mapping[str, WireText]) -> None:
        self._response, self._metadata = content, metadata
        self._status = self.CommandResponseReceived

    def GetResponseContent(self) -> WireText:
        return self._response

    def GetSuccessful(self) -> bool:
        """Return whether the answer says SUCCESS in its metadata; its content does not matter."""
        return self._metadata.get(STATUS_KEY) == SUCCESS

    def GetErrorMessage(self) -> WireText:
        return self._metadata.get(ERROR_KEY, "")
