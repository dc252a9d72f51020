"""Finds the address of a host without waiting: the system's own look-up may take many seconds."""

from __future__ import annotations

import ipaddress
import socket
import threading

POLL_S = 0.005
"""In Slicer another thread runs only while the main thread waits, so it has to wait a little."""

_running: dict[str, AddressLookup] = {}


class AddressLookup:
    """One look-up; only names need one, and a thread for it.

    OpenIGTLink's client speaks IPv4 alone, so other addresses are no use.
    """

    def __init__(self, host: str) -> None:
        self._host = host
        self._ip: str | None = _numericAddress(host)
        self._thread: threading.Thread | None = None
        if self._ip is None:
            self._thread = threading.Thread(target=self._lookUp, daemon=True)
            self._thread.start()

    def process(self) -> str | None:
        """Return the address, empty where the host has none, or None while it is looked up."""
        if self._thread is not None and self._ip is None:
            self._thread.join(POLL_S)
        return self._ip

    def _lookUp(self) -> None:
        try:
            found = socket.getaddrinfo(self._host, None, socket.AF_INET, socket.SOCK_STREAM)
            self._ip = found[0][4][0]
        except (OSError, UnicodeError):
            self._ip = ""


def lookUp(host: str) -> AddressLookup:
    """Begin to look a host up, or join the look-up of it that is still running."""
    lookup = _running.get(host)
    if lookup is None or lookup.process() is not None:
        lookup = _running[host] = AddressLookup(host)
    return lookup


def _numericAddress(host: str) -> str | None:
    """Return the IPv4 address that needs no look-up, empty for an IPv6 one, else None."""
    if host.lower() == "localhost":
        return "127.0.0.1"
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return None
    return str(address) if address.version == 4 else ""
