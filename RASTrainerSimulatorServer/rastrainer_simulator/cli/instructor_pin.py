"""`rastrainer instructor-pin`: set the PIN that a seat asks of its instructors."""

from __future__ import annotations

import argparse
import getpass
import sys

from rastrainer.errors import InputError
from rastrainer_simulator.cli.options import add_config
from rastrainer_simulator.ops.folders import config_folder
from rastrainer_simulator.ops.instructor_pin import PIN_WORDS, InstructorPin


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "instructor-pin",
        help="set the PIN that instructors need at this seat",
        description=(
            f"Asks for a PIN of {PIN_WORDS}, twice, or reads it from a pipe. With it, a teacher's "
            "board may pause this simulator, show the trainee a sentence and start a replay; and "
            "at the simulator, settings, order of tasks and another view's taking the control "
            "are locked until it is entered. Without a PIN, no board can do anything, and "
            "nothing is locked."
        ),
    )
    parser.add_argument("--remove", action="store_true", help="have no PIN any more")
    add_config(parser)
    parser.set_defaults(run=run)


def run(arguments: argparse.Namespace) -> int:
    """Set or remove the PIN, and return the exit status.

    Raises:
        InputError: it is no PIN, the two differ, or it cannot be kept.
    """
    pin = InstructorPin(arguments.config or config_folder())
    if arguments.remove:
        pin.set("")
        print("There is no PIN any more: no board can give orders, and nothing is locked.")
        return 0
    chosen = _asked()
    if not chosen:
        raise InputError(f"A PIN has {PIN_WORDS}; --remove removes it.")
    pin.set(chosen)
    print("The PIN is set; a simulator that is running asks for it from now on.")
    return 0


def _asked() -> str:
    if not sys.stdin.isatty():
        return sys.stdin.readline().strip()
    first = getpass.getpass("PIN: ")
    if getpass.getpass("PIN again: ") != first:
        raise InputError("The two PINs differ.")
    return first
