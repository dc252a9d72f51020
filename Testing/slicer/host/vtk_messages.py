"""What VTK complains of: Slicer's error log shows it, and a red icon in the status bar."""

from __future__ import annotations

from typing import Any

import vtk

from Testing.slicer.host.failures import FAILURES

_NO_SCREEN = "bad X server connection"
"""A computer of tests has no screen, which Slicer has."""
_EVENTS = ("ErrorEvent", "WarningEvent")


class VtkMessages:
    """Takes errors and warnings as failures, until `close`."""

    def __init__(self) -> None:
        self._window = vtk.vtkOutputWindow.GetInstance()
        self._tags = [self._window.AddObserver(event, _take) for event in _EVENTS]

    def close(self) -> None:
        """Listen no more."""
        for tag in self._tags:
            self._window.RemoveObserver(tag)


@vtk.calldata_type(vtk.VTK_STRING)
def _take(_window: Any, _event: str, text: str) -> None:
    if _NO_SCREEN not in text:
        FAILURES.add(text.strip())
