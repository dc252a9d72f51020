"""Finds a port for the simulator without asking anyone."""

from __future__ import annotations

import socket

from rastrainer.protocol import DEFAULT_HOST

ANY = 0
"""Asks the system for any free port."""


def freePort(preferred: int) -> int:
    """Return the preferred port where nobody listens on it, `ANY` otherwise."""
    try:
        socket.create_server((DEFAULT_HOST, preferred)).close()
    except OSError:
        return ANY
    return preferred
