"""The stand-ins of the connector and its commands, for a link without desktop Slicer."""

from __future__ import annotations

from rastrainer.slicer.connector_kit import ConnectorKit
from rastrainer.slicer.headless_command import HeadlessCommand
from rastrainer.slicer.headless_connector import HeadlessConnector


def headlessKit() -> ConnectorKit:
    """Return what makes the stand-ins."""
    return ConnectorKit(HeadlessConnector, HeadlessCommand)
