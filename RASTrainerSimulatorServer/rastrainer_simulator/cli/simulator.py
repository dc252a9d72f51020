"""The command that runs the simulator: `rastrainer simulator`."""

from __future__ import annotations

import argparse
import asyncio
import secrets
from functools import partial

from rastrainer.errors import InputError
from rastrainer_simulator.cli.printing import announce
from rastrainer_simulator.ops.log_files import keep_logs
from rastrainer_simulator.ops.processes import has_display
from rastrainer_simulator.ops.system_paths import log_folder
from rastrainer_simulator.server.server import ServerOptions, SimulatorServer

NO_DISPLAY = (
    "--desktop needs a display, and there is none (DISPLAY and WAYLAND_DISPLAY are not set): leave "
    "it out, and open the page in a browser."
)


def run_simulator(arguments: argparse.Namespace) -> int:
    has_port = arguments.view_port is not None
    others = {"view-port": has_port, "lan": arguments.lan, "desktop": arguments.desktop}
    for name in (name for name, is_given in others.items() if is_given and arguments.no_views):
        raise InputError(f"--{name} and --no-views exclude each other.")
    if arguments.desktop and not has_display():
        raise InputError(NO_DISPLAY)
    own = None if arguments.config is None else arguments.config / "logs"
    logs = arguments.log_folder or own or log_folder()
    options = ServerOptions(
        records=arguments.records,
        host=arguments.host,
        port=arguments.port,
        view_port=arguments.view_port,
        has_views=not arguments.no_views,
        has_network=arguments.lan,
        has_gamepad=arguments.gamepad,
        has_desktop=arguments.desktop,
        config=arguments.config,
        resumes=arguments.resume,
        scores_alone=arguments.own_score,
        connect_to=None if arguments.connect is None else _address(arguments.connect),
        speed=arguments.speed,
        scenario=arguments.scenario,
        robot_meshes=arguments.robot_meshes,
        seed=secrets.randbits(63) if arguments.seed is None else arguments.seed,
        is_seeded=arguments.seed is not None,
    )
    with keep_logs(logs, f"simulator-{arguments.port}"):
        server = SimulatorServer(options)
        asyncio.run(server.run(partial(announce, "simulator")))
    return 0


def _address(text: str) -> tuple[str, int]:
    host, _colon, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise InputError("--connect must be HOST:PORT, such as 127.0.0.1:18944.")
    return host, int(port)
