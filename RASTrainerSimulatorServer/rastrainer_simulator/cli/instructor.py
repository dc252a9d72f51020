"""Commands for instructors: `rastrainer board` and `rastrainer instructor-pin`."""

from __future__ import annotations

import argparse
import asyncio
import getpass
import sys
from functools import partial

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.board.board_server import BoardServer
from rastrainer_simulator.board.seats import SeatClient
from rastrainer_simulator.cli.printing import announce
from rastrainer_simulator.ops.instructor_pin import PIN_WORDS, InstructorPin
from rastrainer_simulator.ops.processes import stop_on_signals
from rastrainer_simulator.ops.system_paths import config_folder


def serve_board(arguments: argparse.Namespace) -> int:
    asyncio.run(_serve(arguments))
    return 0


async def _serve(arguments: argparse.Namespace) -> None:
    tell, stop = partial(announce, "board"), asyncio.Event()
    async with SeatClient() as client:
        board = BoardServer(
            arguments.config or config_folder(),
            client,
            lambda code: tell(f"has a new pairing code for browsers: {code}"),
            study=arguments.study,
        )
        try:
            with stop_on_signals(stop):
                found = await board.listen(DEFAULT_HOST, arguments.port)
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
