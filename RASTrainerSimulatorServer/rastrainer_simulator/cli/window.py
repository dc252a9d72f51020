"""`rastrainer window`: the desktop window of a simulator."""

from __future__ import annotations

import argparse
import os
import re
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer_simulator.ops.processes import VIEW_KEY_VARIABLE, has_display

DEFAULT_URL = "http://127.0.0.1:18945"
LEAST_SIDE, MAX_SIDE = 320, 16_384


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "window",
        help="open the desktop window of a running simulator",
        description="Shows the robot, the head and the menus of a simulator that is running, and "
        "sends it the user's input. F11: full screen; F12: save a picture. Not for clinical use.",
    )
    parser.add_argument(
        "--connect",
        metavar="URL",
        default=DEFAULT_URL,
        help="where the simulator serves views (default: %(default)s)",
    )
    parser.add_argument("--code", help="the pairing code that the simulator shows")
    parser.add_argument("--size", metavar="WxH", help="of the window, in pixels")
    parser.add_argument("--fullscreen", action="store_true", help="fill the display")
    parser.add_argument(
        "--quality",
        choices=("auto", "high", "medium", "low"),
        default="auto",
        help="light and shadows (default: what the machine can afford)",
    )
    parser.add_argument(
        "--pictures",
        type=Path,
        metavar="DIR",
        default=Path.home() / "RASTrainer" / "pictures",
        help="folder of the pictures that F12 keeps (default: %(default)s)",
    )
    parser.add_argument(
        "--picture-quality",
        choices=("high", "medium", "low"),
        default="high",
        help="light and shadows of these pictures (default: %(default)s)",
    )
    parser.add_argument(
        "--log-folder", type=Path, metavar="DIR", help="folder of the logs (default: the usual)"
    )
    parser.add_argument("--frame-log", type=Path, help=argparse.SUPPRESS)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Show the window until it is closed and return the exit status.

    Raises:
        InputError: an argument cannot be used, or there is no such simulator.
        RASTrainerError: there is no display.
    """
    size = None if arguments.size is None else _size(arguments.size)
    if not re.match(r"https?://[^/\s]+/?$", arguments.connect):
        raise InputError("--connect must be an address, such as http://127.0.0.1:18945.")
    key = os.environ.get(VIEW_KEY_VARIABLE, "")
    if not key and arguments.code is None:
        raise InputError("--code must be the pairing code that the simulator shows.")
    # Only here: VTK takes time to import.
    import asyncio

    os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
    from rastrainer_simulator.desktop.app import DesktopWindow, WindowOptions
    from rastrainer_simulator.desktop.connection import pair
    from rastrainer_simulator.desktop.performance import Quality
    from rastrainer_simulator.ops.folders import log_folder
    from rastrainer_simulator.ops.log_files import keep_logs

    if arguments.code is not None:
        key = asyncio.run(pair(arguments.connect, arguments.code))
    options = WindowOptions(
        url=arguments.connect,
        key=key,
        size=size,
        is_fullscreen=arguments.fullscreen,
        quality=None if arguments.quality == "auto" else Quality(arguments.quality),
        pictures=arguments.pictures,
        picture_quality=Quality(arguments.picture_quality),
        frame_log=arguments.frame_log,
    )
    with keep_logs(arguments.log_folder or log_folder(), "window"):
        if not has_display():
            raise InputError("No window can be opened on this machine: there is no display.")
        asyncio.run(DesktopWindow(options).run())
    return 0


def _size(text: str) -> tuple[int, int]:
    width, _x, height = text.lower().partition("x")
    if width.isdecimal() and height.isdecimal():
        size = int(width), int(height)
        if min(size) >= LEAST_SIDE and max(size) <= MAX_SIDE:
            return size
    raise InputError(
        "--size must be WIDTHxHEIGHT in pixels, such as 1280x720, "
        f"each from {LEAST_SIDE} to {MAX_SIDE}."
    )
