"""`rastrainer board`: a teacher's page of live tiles of several simulators."""

from __future__ import annotations

import argparse
import asyncio
from functools import partial
from pathlib import Path

from rastrainer.protocol import DEFAULT_HOST
from rastrainer.study.database.database import StudyPlace
from rastrainer_simulator.cli.options import (
    STUDY_HELP,
    add_config,
    add_study,
    announce,
    check_ports,
)

DEFAULT_BOARD_PORT = 18955


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "board",
        help="watch several simulators in one page of live tiles",
        description=(
            "Serves a teacher's board to browsers on this computer until Ctrl-C: who trains where, "
            "task, point, time, contact and last score of each seat, and each seat's scene; with "
            "a study, also where every trainee stands in the curriculum. The seats' addresses and "
            "keys stay on this computer."
        ),
    )
    add_study(
        parser,
        "--study",
        help_text=f"also show the class of this study, which is only read: {STUDY_HELP}",
    )
    parser.add_argument(
        "--port",
        type=int,
        default=DEFAULT_BOARD_PORT,
        help="for browsers on this computer, 0 for any free one (default: %(default)s)",
    )
    add_config(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Serve the board until it is stopped, and return the exit status.

    Raises:
        InputError: the list of seats or the study cannot be read, or the port not listened on.
    """
    check_ports(arguments)
    from rastrainer_simulator.ops.folders import config_folder

    config = arguments.config or config_folder()
    asyncio.run(_serve(config, arguments.port, arguments.study))
    return 0


async def _serve(config: Path, port: int, study: StudyPlace | None) -> None:
    from rastrainer_simulator.board.board_server import BoardServer
    from rastrainer_simulator.board.seats import SeatClient
    from rastrainer_simulator.ops.processes import stop_on_signals

    tell, stop = partial(announce, "board"), asyncio.Event()
    async with SeatClient() as client:
        board = BoardServer(
            config,
            client,
            lambda code: tell(f"has a new pairing code for browsers: {code}"),
            study=study,
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
