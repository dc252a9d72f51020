"""The options of `rastrainer scenario`, and their checked values."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.scenario.library import USER_LIBRARY
from rastrainer.scenario.points import PlannedTarget, PlannedTrajectory
from rastrainer.scenario.scenario import UNKNOWN_LICENSE
from rastrainer.scenario.setup import SetUp, read_setup
from rastrainer.scenario.writer import scenario_name
from rastrainer_simulator.cli import arg

if TYPE_CHECKING:
    from rastrainer_simulator.authoring.make import ScenarioOptions

LONGEST_TITLE, LONGEST_NAME, LONGEST_TEXT = 80, 60, 4000


HEAD_OPTIONS = (
    arg.option(
        "--threshold", type=float, help="value that separates air from skin (default: estimated)"
    ),
    arg.option("--cut", type=float, metavar="S", help="height of the flat base, mm superior"),
    arg.option(
        "--orientation",
        metavar="LAS",
        help="how the axes of a file run that states none: to the left, anterior, superior",
    ),
)
"""How the head is found in a volume."""
LIBRARY = arg.option(
    "--library",
    type=arg.path_of_user,
    default=f"~/{USER_LIBRARY}",
    metavar="DIR",
    help="folder of your scenarios",
)
OUTPUT = (
    arg.output("a new one", required=True),
    arg.option("--title", help="default: the name of the new folder"),
)
PLAN = (
    arg.option(
        "--target",
        nargs=4,
        action="append",
        default=[],
        metavar=("NAME", "R", "A", "S"),
        help="a planned target, RAS mm; may be repeated: the error is reported at the first",
    ),
    arg.option(
        "--trajectory",
        nargs=7,
        metavar=("NAME", "ER", "EA", "ES", "TR", "TA", "TS"),
        help="a planned trajectory from entry to target, RAS mm",
    ),
)
OPTIONS = (
    *OUTPUT,
    *PLAN,
    arg.option("--source", help="where the images come from (default: the volume's name)"),
    arg.option("--license", default=UNKNOWN_LICENSE, help="under which it may be used"),
    arg.path("--setup", "JSON", "head, table and robot base"),
    arg.number("--seed", 1, "of the proposed tasks", 0, 2**31 - 1),
    arg.option(
        "--tasks",
        nargs="+",
        type=Path,
        default=[],
        metavar="MRK_JSON",
        help="manually placed fiducials: the trial run, Task 1, Task 2 …",
    ),
    arg.flag("--check", "only check whether set-up, plan and placed fiducials can be used"),
)
"""The options of a new scenario, read by `options_of`."""


def procedure_option(what: str) -> arg.Argument:
    """Return the argument of a procedure's file; `what` says what becomes of it."""
    text = f"a procedure as in scenario.json, its meshes in the folder no-go beside it: {what}"
    return arg.path("--procedure", "JSON", text)


def options_of(arguments: argparse.Namespace, source: str) -> ScenarioOptions:
    """Return the options of a command line; `source` is the default for its source."""
    # Only here: it needs the robot, which takes time to import.
    from rastrainer_simulator.authoring.make import ScenarioOptions

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
    return tuple(
        PlannedTarget(_text("--target", name, LONGEST_NAME), _numbers("--target", numbers))
        for name, *numbers in arguments.target
    )


def trajectory_of(arguments: argparse.Namespace) -> PlannedTrajectory | None:
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
