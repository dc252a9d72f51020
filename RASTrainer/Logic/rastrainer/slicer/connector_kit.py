"""Where the connector and its commands come from: the extension, or our stand-ins."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import slicer


@dataclass(frozen=True)
class ConnectorKit:
    """Makes the two objects that the link talks to.

    Attributes:
        makeConnector: returns a new `vtkMRMLIGTLConnectorNode`, or a stand-in.
        makeCommand: returns a new `vtkSlicerOpenIGTLinkCommand`, or a stand-in.
    """

    makeConnector: Callable[[], Any]
    makeCommand: Callable[[], Any]


def desktopKit() -> ConnectorKit | None:
    """Return what SlicerOpenIGTLink brings, or None where that extension is not installed."""
    if not hasattr(slicer, "vtkMRMLIGTLConnectorNode"):
        return None
    return ConnectorKit(slicer.vtkMRMLIGTLConnectorNode, slicer.vtkSlicerOpenIGTLinkCommand)
