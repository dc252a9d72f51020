"""Start serving views: the port, the keys agreed on before, and the sentence for the terminal."""

from __future__ import annotations

import asyncio
import os
import socket
from collections.abc import Callable
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_VIEW_PORT
from rastrainer_simulator.loop.results import StateSource
from rastrainer_simulator.net.limits import ViewLimits
from rastrainer_simulator.net.views.access_control import LONGEST_KEY, SHORTEST_KEY
from rastrainer_simulator.net.views.view_server import ViewServer
from rastrainer_simulator.ops.instructor_pin import PinGuesses
from rastrainer_simulator.ops.processes import VIEW_KEY_VARIABLE
from rastrainer_simulator.presentation.presenter import Presenter


async def start_view_server(
    source: StateSource,
    presenter: Presenter,
    announce: Callable[[str], None],
    port: int | None,
    robot_meshes: Path | None,
    certificates: Path | None = None,
    scenario_picture: Callable[[str], Path | None] = lambda _name: None,
    limits: ViewLimits | None = None,
    config: Path | None = None,
    pin: PinGuesses | None = None,
) -> ViewServer:
    """Return a server that listens on this computer; `announce` is given what people must know.

    With a folder for certificates it listens to the local network, too, by TLS: on the next port
    or, where that is taken, any free one.

    `port` 0 is any free one, None the usual one or, where that is taken, any free one. A key in
    the environment variable `RASTRAINER_VIEW_KEY` is accepted: who starts the simulator may give
    the same one to a window.

    `scenario_picture` returns the picture of a scenario by its name; `limits` are those of
    `ViewLimits` unless a site has its own. `config` is the folder of the settings, which keeps the
    keys of teachers' boards, and `pin` lets these give orders.

    Raises:
        InputError: the port cannot be listened on, the key is no key, the certificate cannot be
            kept, or the keys of boards cannot be read.
    """

    def announce_new_code(code: str) -> None:
        announce(f"has a new pairing code for views: {code}")

    server = ViewServer(
        source, presenter, announce_new_code, robot_meshes, limits, scenario_picture, config, pin
    )
    agreed = os.environ.get(VIEW_KEY_VARIABLE)
    if agreed is not None:
        if not SHORTEST_KEY <= len(agreed) <= LONGEST_KEY:
            raise InputError(
                f"{VIEW_KEY_VARIABLE} must have {SHORTEST_KEY} to {LONGEST_KEY} letters."
            )
        server.sessions.admit(agreed)
    found = await _listen(server, port)
    where = f"http://{DEFAULT_HOST}:{found}"
    announce(f"serves views on {where}, pairing code {server.code.code}")
    if certificates is not None:
        await _listen_in_network(server, found, certificates, announce)
    return server


async def _listen_in_network(
    server: ViewServer, local: int, certificates: Path, announce: Callable[[str], None]
) -> None:
    from rastrainer_simulator.net.views.certificate import own_addresses, own_certificate

    certificate = await asyncio.to_thread(own_certificate, certificates)
    try:
        found = await server.listen_in_network(local + 1, certificate.tls)
    except InputError:
        found = await server.listen_in_network(0, certificate.tls)
    addresses = [address for address in own_addresses() if ":" not in address]
    pages = [f"https://{name}:{found}" for name in addresses or [socket.gethostname()]]
    server.announce(*pages)
    where = " or ".join(pages)
    announce(
        f"serves the local network on {where}; the browser warns of a certificate made here: "
        f"compare its SHA-256 fingerprint, {certificate.fingerprint}"
    )
    announce(
        f"serves a headset on a USB cable: adb reverse tcp:{local} tcp:{local}, then open "
        f"http://localhost:{local} in its browser"
    )


async def _listen(server: ViewServer, port: int | None) -> int:
    if port is not None:
        return await server.listen(DEFAULT_HOST, port)
    try:
        return await server.listen(DEFAULT_HOST, DEFAULT_VIEW_PORT)
    except InputError:
        return await server.listen(DEFAULT_HOST, 0)
