"""The options of `rastrainer scenario`, and their checked values."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.procedure.plan import Procedure, read_procedure
from rastrainer.scenario.library import USER_LIBRARY
from rastrainer.scenario.points import PlannedTarget, PlannedTrajectory
from rastrainer.scenario.scenario import UNKNOWN_LICENSE
from rastrainer.scenario.setup import SetUp, read_setup
from rastrainer.scenario.writer import scenario_name
from rastrainer_simulator.cli.options import path_of_user

if TYPE_CHECKING:
    from rastrainer_simulator.authoring.make import ScenarioOptions

LONGEST_TITLE, LONGEST_NAME, LONGEST_TEXT = 80, 60, 4000


def add_head_options(parser: argparse.ArgumentParser) -> None:
    """Add how the head is found in a volume to an action's parser."""
    parser.add_argument(
        "--threshold", type=float, help="value that separates air from skin (default: estimated)"
    )
    parser.add_argument(
        "--cut", type=float, metavar="S", help="height of the flat base, mm superior"
    )
    parser.add_argument(
        "--orientation",
        metavar="LAS",
        help="how the axes of a file run that states none: to the left, anterior, superior",
    )


def add_library(parser: argparse.ArgumentParser) -> None:
    """Add the folder of the user's own scenarios to an action's parser."""
    parser.add_argument(
        "--library",
        type=path_of_user,
        default=f"~/{USER_LIBRARY}",
        metavar="DIR",
        help="folder of your scenarios",
    )


def add_output(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR", help="a new one")
    parser.add_argument("--title", help="default: the name of the new folder")


def add_procedure(parser: argparse.ArgumentParser, what: str) -> None:
    """Add a procedure's file to an action's parser; `what` says what becomes of it."""
    parser.add_argument(
        "--procedure",
        type=Path,
        metavar="JSON",
        help=f"a procedure as in scenario.json, its meshes in the folder no-go beside it: {what}",
    )


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add what a new scenario is made with to an action's parser."""
    add_output(parser)
    add_plan(parser)
    parser.add_argument("--source", help="where the images come from (default: the volume's name)")
    parser.add_argument("--license", default=UNKNOWN_LICENSE, help="under which it may be used")
    parser.add_argument("--setup", type=Path, metavar="JSON", help="head, table and robot base")
    parser.add_argument("--seed", type=int, default=1, help="of the proposed tasks")
    parser.add_argument(
        "--tasks",
        nargs="+",
        type=Path,
        default=[],
        metavar="MRK_JSON",
        help="manually placed fiducials: the trial run, Task 1, Task 2 …",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="only check whether set-up, plan and placed fiducials can be used",
    )


def add_plan(parser: argparse.ArgumentParser) -> None:
    """Add targets and a trajectory to an action's parser."""
    parser.add_argument(
        "--target",
        nargs=4,
        action="append",
        default=[],
        metavar=("NAME", "R", "A", "S"),
        help="a planned target, RAS mm; may be repeated: the error is reported at the first",
    )
    parser.add_argument(
        "--trajectory",
        nargs=7,
        metavar=("NAME", "ER", "EA", "ES", "TR", "TA", "TS"),
        help="a planned trajectory from entry to target, RAS mm",
    )


def options_of(arguments: argparse.Namespace, source: str) -> ScenarioOptions:
    """Return the options of a command line; `source` is the default for its source."""
    # Only here: it needs the robot, which takes time to import.
    from rastrainer_simulator.authoring.make import ScenarioOptions

    if not 0 <= arguments.seed < 2**31:
        raise InputError("--seed must be from 0 to 2147483647.")
    return ScenarioOptions(
        title=title_of(arguments),
        source=_text("--source", arguments.source or source, LONGEST_TEXT),
        license=_text("--license", arguments.license, LONGEST_TEXT),
        setup=read_setup(arguments.setup) if arguments.setup else SetUp(),
        targets=targets_of(arguments),
        trajectory=trajectory_of(arguments),
        task_files=tuple(arguments.tasks),
        seed=arguments.seed,
    )


def title_of(arguments: argparse.Namespace) -> str:
    """Return the title of a new scenario, of which a name can be made; else raise `InputError`."""
    title = _text("--title", arguments.title or arguments.output.absolute().name, LONGEST_TITLE)
    scenario_name(title)
    return title


def targets_of(arguments: argparse.Namespace) -> tuple[PlannedTarget, ...]:
    """Return the planned targets; raise `InputError` if one cannot be used."""
    return tuple(
        PlannedTarget(_text("--target", name, LONGEST_NAME), _numbers("--target", numbers))
        for name, *numbers in arguments.target
    )


def trajectory_of(arguments: argparse.Namespace) -> PlannedTrajectory | None:
    """Return the planned trajectory; raise `InputError` if it cannot be used."""
    if not arguments.trajectory:
        return None
    name, *numbers = arguments.trajectory
    places = _numbers("--trajectory", numbers)
    return PlannedTrajectory(_text("--trajectory", name, LONGEST_NAME), places[:3], places[3:])


def head_arguments(arguments: argparse.Namespace) -> list[str]:
    """Return how the head is found, for the process that finds it."""
    named = ("threshold", "cut", "orientation")
    given = ((name, getattr(arguments, name)) for name in named)
    return [f"--{name}={value}" for name, value in given if value is not None]


def procedure_of(arguments: argparse.Namespace) -> Procedure | None:
    """Return the procedure of a command line; raise `InputError` if it cannot be used."""
    return None if arguments.procedure is None else read_procedure(arguments.procedure)


def _text(option: str, text: str, longest: int) -> str:
    if not 1 <= len(text) <= longest or not text.isprintable():
        raise InputError(f"{option} must be printable text of 1 to {longest} characters.")
    return text


def _numbers(option: str, words: list[str]) -> np.ndarray:
    try:
        numbers = np.array([float(word) for word in words])
    except ValueError:
        raise InputError(f"{option} needs numbers after its name, RAS mm.") from None
    if not (np.abs(numbers) <= RAS_LIMIT_MM).all():
        raise InputError(f"{option} must be within ±{RAS_LIMIT_MM:g} mm.")
    return numbers
