"""Ports for servers whose port has to be known before they listen, or after they have ended."""

from __future__ import annotations

import itertools
import os
import random
import socket

# Systems assign higher ports to programs that ask for any (Linux from 32768): a port that is free
# stays free, though other tests open connections all the time.
_FIRST, _OF_A_WORKER = 20_000, 1_000
_WORKER = int(os.environ.get("PYTEST_XDIST_WORKER", "gw9").removeprefix("gw"))
# Starts at random, in case the tests run twice at the same time.
_numbers = itertools.count(random.Random().randrange(_OF_A_WORKER))


def free_port() -> int:
    """Return a port of 127.0.0.1 at which no program listens, and that no other test gets."""
    for number in itertools.islice(_numbers, _OF_A_WORKER):
        port = _FIRST + (_WORKER % 10) * _OF_A_WORKER + number % _OF_A_WORKER
        try:
            socket.create_server(("127.0.0.1", port)).close()
        except OSError:
            continue
        return port
    raise OSError("No port is free.")
