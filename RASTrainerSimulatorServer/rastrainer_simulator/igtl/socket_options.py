"""How the operating system treats a client's connection."""

from __future__ import annotations

import contextlib
import socket

from rastrainer_simulator.igtl.limits import Limits


def set_up_socket(peer: socket.socket, limits: Limits) -> None:
    """Queue little in the kernel, and notice a machine that has gone."""
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, limits.buffer_bytes)
    peer.setsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1)
    probe_s = max(1, int(limits.silent_peer_s / 6))
    options = {
        "TCP_KEEPIDLE": probe_s * 3,
        "TCP_KEEPINTVL": probe_s,
        "TCP_KEEPCNT": 3,
        "TCP_USER_TIMEOUT": int(limits.silent_peer_s * 1000),
    }
    for name, value in options.items():
        # Not every system has every option; each is a help, none a need.
        with contextlib.suppress(AttributeError, OSError):
            peer.setsockopt(socket.IPPROTO_TCP, getattr(socket, name), value)
