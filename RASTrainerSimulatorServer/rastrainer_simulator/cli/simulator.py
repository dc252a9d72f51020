"""The command that runs the simulator: `rastrainer simulator`."""

from __future__ import annotations

import argparse
import asyncio
import secrets
from functools import partial
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT, DEFAULT_VIEW_PORT
from rastrainer_simulator.cli.options import (
    add_config,
    add_records,
    announce,
    check_ports,
)
from rastrainer_simulator.ops.log_files import keep_logs
from rastrainer_simulator.ops.processes import has_display
from rastrainer_simulator.ops.system_paths import log_folder

FASTEST = 1000.0
LARGEST_SEED = 2**63 - 1
NO_DISPLAY = (
    "--desktop needs a display, and there is none (DISPLAY and WAYLAND_DISPLAY are not set): leave "
    "it out, and open the page in a browser."
)


def add_simulator_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add `simulator`: the robot, the head and the trial, for Slicer and the views."""
    parser = subparsers.add_parser(
        "simulator",
        help="run the simulator, which Slicer and the views connect to",
        description="Serves OpenIGTLink and the views until Ctrl-C. Not for clinical use.",
    )
    parser.add_argument("--host", default=DEFAULT_HOST, help="address to listen on")
    parser.add_argument(
        "--port",
        type=int,
        default=DEFAULT_PORT,
        help="port to listen on, 0 for any free one",
    )
    parser.add_argument(
        "--connect", metavar="HOST:PORT", help="connect to a listening Slicer instead"
    )
    parser.add_argument(
        "--view-port",
        type=int,
        help="port for the browser, 0 for any free one (default: "
        f"{DEFAULT_VIEW_PORT}, or any free one where that is taken)",
    )
    parser.add_argument(
        "--lan",
        action="store_true",
        help="serve browsers and headsets in the local network, too, by https with a certificate "
        "made on this computer",
    )
    parser.add_argument(
        "--no-views", action="store_true", help="serve OpenIGTLink only, no page for browsers"
    )
    parser.add_argument("--speed", type=float, default=1.0, help="simulated seconds a second")
    parser.add_argument(
        "--seed",
        type=int,
        help="of the heads' poses, for tests: no study counts such trials (default: none; the "
        "poses cannot be predicted)",
    )
    add_records(parser)
    parser.add_argument(
        "--scenario", type=Path, metavar="DIR", help="a scenario of your own (default: Colin27)"
    )
    parser.add_argument(
        "--robot-meshes", type=Path, metavar="DIR", help="the robot's official meshes"
    )
    parser.add_argument(
        "--desktop",
        action="store_true",
        help="open the page in a window of its own; the simulator ends when it is closed",
    )
    parser.add_argument(
        "--gamepad",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="read the gamepads of this computer",
    )
    add_config(parser)
    parser.add_argument(
        "--resume",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="resume the newest trial where it was interrupted; it is paused until it is "
        "resumed or aborted",
    )
    parser.add_argument(
        "--own-score",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="score a trial outside of a study in the simulator where no Slicer is connected when "
        "it ends",
    )
    parser.add_argument(
        "--log-folder",
        type=Path,
        metavar="DIR",
        help="folder of the logs (default: the usual, or logs in that of --config)",
    )
    parser.set_defaults(run=run_simulator)


def run_simulator(arguments: argparse.Namespace) -> int:
    """Run the simulator until it is stopped, and return the exit status."""
    _check(arguments)
    connect_to = None if arguments.connect is None else _address(arguments.connect)
    # Only here: the robot and the scenario take time to import.
    from rastrainer_simulator.server.server import ServerOptions, SimulatorServer

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
        logs=logs,
        resumes=arguments.resume,
        scores_alone=arguments.own_score,
        connect_to=connect_to,
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


def _check(arguments: argparse.Namespace) -> None:
    check_ports(arguments)
    if arguments.no_views and arguments.view_port is not None:
        raise InputError("--view-port and --no-views exclude each other.")
    if arguments.no_views and arguments.lan:
        raise InputError("--lan and --no-views exclude each other.")
    if arguments.no_views and arguments.desktop:
        raise InputError("--desktop and --no-views exclude each other.")
    if arguments.desktop and not has_display():
        raise InputError(NO_DISPLAY)
    if not 0.0 < arguments.speed <= FASTEST:
        raise InputError(f"--speed must be above 0 and at most {FASTEST:g}.")
    if arguments.seed is not None and not 0 <= arguments.seed <= LARGEST_SEED:
        raise InputError(f"--seed must be from 0 to {LARGEST_SEED}.")


def _address(text: str) -> tuple[str, int]:
    host, _colon, port = text.rpartition(":")
    if not host or not port.isdecimal() or not 0 < int(port) < 65536:
        raise InputError("--connect must be HOST:PORT, such as 127.0.0.1:18944.")
    return host, int(port)
