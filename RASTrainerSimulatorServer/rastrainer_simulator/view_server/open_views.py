"""Start serving views: the port, the keys agreed on before, and the sentence for the terminal."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.control_loop import ControlLoop
from rastrainer_simulator.simulator_command import DEFAULT_VIEW_PORT
from rastrainer_simulator.view_server.operator_desk import OperatorDesk
from rastrainer_simulator.view_server.sessions import LONGEST_KEY, SHORTEST_KEY
from rastrainer_simulator.view_server.view_server import ViewServer

KEY_VARIABLE = "RASTRAINER_VIEW_KEY"


async def open_views(
    control_loop: ControlLoop,
    desk: OperatorDesk,
    tell: Callable[[str], None],
    port: int | None,
    robot_meshes: Path | None,
) -> ViewServer:
    """Return a server that listens on this computer; `tell` is given what people must know.

    `port` 0 is any free one, None the usual one or, where that is taken, any free one. A key in
    the environment variable `RASTRAINER_VIEW_KEY` is accepted: who starts the simulator may give
    the same one to a window.

    Raises:
        InputError: the port cannot be listened on, or the key is no key.
    """

    def tell_new_code(code: str) -> None:
        tell(f"has a new pairing code for views: {code}")

    server = ViewServer(control_loop, desk, tell_new_code, robot_meshes)
    agreed = os.environ.get(KEY_VARIABLE)
    if agreed is not None:
        if not SHORTEST_KEY <= len(agreed) <= LONGEST_KEY:
            raise InputError(f"{KEY_VARIABLE} must have {SHORTEST_KEY} to {LONGEST_KEY} letters.")
        server.sessions.admit(agreed)
    found = await _listen(server, port)
    where = f"http://{DEFAULT_HOST}:{found}"
    tell(f"serves views on {where}, pairing code {server.code.code}")
    return server


async def _listen(server: ViewServer, port: int | None) -> int:
    if port is not None:
        return await server.listen(DEFAULT_HOST, port)
    try:
        return await server.listen(DEFAULT_HOST, DEFAULT_VIEW_PORT)
    except InputError:
        return await server.listen(DEFAULT_HOST, 0)
