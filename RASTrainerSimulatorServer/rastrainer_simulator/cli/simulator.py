"""The command that runs the simulator: `rastrainer simulator`."""

from __future__ import annotations

import argparse
import asyncio
import secrets
from functools import partial

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT, DEFAULT_VIEW_PORT
from rastrainer_simulator.cli import arg
from rastrainer_simulator.cli.options import Subcommand, announce
from rastrainer_simulator.ops.log_files import keep_logs
from rastrainer_simulator.ops.processes import has_display
from rastrainer_simulator.ops.system_paths import log_folder

SLOWEST, FASTEST = 0.001, 1000.0
LARGEST_SEED = 2**63 - 1
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
        resumes=arguments.resume,
        scores_alone=arguments.own_score,
        connect_to=arguments.connect,
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
        raise argparse.ArgumentTypeError("must be HOST:PORT, such as 127.0.0.1:18944")
    return host, int(port)


COMMANDS = (
    Subcommand(
        "simulator",
        "run the simulator, which Slicer and the views connect to",
        run_simulator,
        (
            arg.option("--host", default=DEFAULT_HOST, help="address to listen on"),
            arg.port("--port", DEFAULT_PORT, "port to listen on, 0 for any free one"),
            arg.option(
                "--connect",
                type=_address,
                metavar="HOST:PORT",
                help="connect to a listening Slicer instead",
            ),
            arg.port(
                "--view-port",
                None,
                "port for the browser, 0 for any free one (default: "
                f"{DEFAULT_VIEW_PORT}, or any free one where that is taken)",
            ),
            arg.flag(
                "--lan",
                "serve browsers and headsets in the local network, too, by https with a "
                "certificate made on this computer",
            ),
            arg.flag("--no-views", "serve OpenIGTLink only, no page for browsers"),
            arg.number("--speed", 1.0, "simulated seconds a second", SLOWEST, FASTEST),
            arg.number(
                "--seed",
                None,
                "of the heads' poses, for tests: no study counts such trials (default: none; "
                "the poses cannot be predicted)",
                0,
                LARGEST_SEED,
            ),
            arg.RECORDS,
            arg.path("--scenario", "DIR", "a scenario of your own (default: Colin27)"),
            arg.path("--robot-meshes", "DIR", "the robot's official meshes"),
            arg.flag(
                "--desktop",
                "open the page in a window of its own; the simulator ends when it is closed",
            ),
            arg.switch("--gamepad", "read the gamepads of this computer"),
            arg.CONFIG,
            arg.switch(
                "--resume",
                "resume the newest trial where it was interrupted; it is paused until it is "
                "resumed or aborted",
            ),
            arg.switch(
                "--own-score",
                "score a trial outside of a study in the simulator where no Slicer is connected "
                "when it ends",
            ),
            arg.path(
                "--log-folder",
                "DIR",
                "folder of the logs (default: the usual, or logs in that of --config)",
            ),
        ),
        "Serves OpenIGTLink and the views until Ctrl-C. Not for clinical use.",
    ),
)
