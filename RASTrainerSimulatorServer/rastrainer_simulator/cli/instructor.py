"""Commands for instructors: `rastrainer board` and `rastrainer instructor-pin`."""

from __future__ import annotations

import argparse
import asyncio
import getpass
import sys
from functools import partial
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST
from rastrainer.study.database.database import StudyPlace
from rastrainer_simulator.cli import arg
from rastrainer_simulator.cli.options import Subcommand, announce
from rastrainer_simulator.ops.instructor_pin import PIN_WORDS, InstructorPin
from rastrainer_simulator.ops.system_paths import config_folder

DEFAULT_BOARD_PORT = 18955


def serve_board(arguments: argparse.Namespace) -> int:
    config = arguments.config or config_folder()
    asyncio.run(_serve(config, arguments.port, arguments.study))
    return 0


async def _serve(config: Path, port: int, place: StudyPlace | None) -> None:
    from rastrainer_simulator.board.board_server import BoardServer
    from rastrainer_simulator.board.seats import SeatClient
    from rastrainer_simulator.ops.processes import stop_on_signals

    tell, stop = partial(announce, "board"), asyncio.Event()
    async with SeatClient() as client:
        board = BoardServer(
            config,
            client,
            lambda code: tell(f"has a new pairing code for browsers: {code}"),
            study=place,
        )
        try:
            with stop_on_signals(stop):
                found = await board.listen(DEFAULT_HOST, port)
                address = f"http://{DEFAULT_HOST}:{found}"
                code = board.code.code
                tell(f"is on {address}, pairing code {code}; open {address}/#code={code}")
                await stop.wait()
        finally:
            await board.close()


def set_pin(arguments: argparse.Namespace) -> int:
    pin = InstructorPin(arguments.config or config_folder())
    if arguments.remove:
        pin.set("")
        print("There is no PIN any more: no board can give orders, and nothing is locked.")
        return 0
    if sys.stdin.isatty():
        chosen = getpass.getpass("PIN: ")
        if getpass.getpass("PIN again: ") != chosen:
            raise InputError("The two PINs differ.")
    else:
        chosen = sys.stdin.readline().strip()
    if not chosen:
        raise InputError(f"A PIN has {PIN_WORDS}; --remove removes it.")
    pin.set(chosen)
    print("The PIN is set; a simulator that is running asks for it from now on.")
    return 0


COMMANDS = (
    Subcommand(
        "board",
        "watch several simulators in one page of live tiles",
        serve_board,
        (
            arg.study(
                "--study",
                f"also show the class of this study, which is only read: {arg.STUDY_HELP}",
            ),
            arg.port(
                "--port", DEFAULT_BOARD_PORT, "for browsers on this computer, 0 for any free one"
            ),
            arg.CONFIG,
        ),
        "Serves a teacher's board to browsers on this computer until Ctrl-C: who trains where, "
        "task, point, time, contact and last score of each seat, and each seat's scene; with a "
        "study, also where every trainee stands in the curriculum. The seats' addresses and keys "
        "stay on this computer.",
    ),
    Subcommand(
        "instructor-pin",
        "set the PIN that instructors need at this seat",
        set_pin,
        (arg.flag("--remove", "have no PIN any more"), arg.CONFIG),
        f"Asks for a PIN of {PIN_WORDS}, twice, or reads it from a pipe. With it, a teacher's "
        "board may pause this simulator, show the trainee a sentence and start a replay; and at "
        "the simulator, settings, order of tasks and another view's taking the control are locked "
        "until it is entered. Without a PIN, no board can do anything, and nothing is locked.",
    ),
)
