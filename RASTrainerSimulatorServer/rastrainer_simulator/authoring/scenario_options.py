"""What the command line says of a scenario, checked."""

from __future__ import annotations

import argparse

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import RAS_LIMIT_MM
from rastrainer.scenario.setup import SetUp, read_setup
from rastrainer.scenario.tasks import PlannedTarget, PlannedTrajectory
from rastrainer.scenario.writer import scenario_name
from rastrainer_simulator.authoring.make import ScenarioOptions

LONGEST_TITLE, LONGEST_NAME, LONGEST_TEXT = 80, 60, 4000


def options_of(arguments: argparse.Namespace, source: str) -> ScenarioOptions:
    """Return the options of a command line; `source` is the default for its source.

    Raises:
        InputError: a text or a number cannot be used.
    """
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
    """Return the planned targets; raise `InputError` where one cannot be used."""
    return tuple(
        PlannedTarget(_text("--target", name, LONGEST_NAME), _numbers("--target", numbers))
        for name, *numbers in arguments.target
    )


def trajectory_of(arguments: argparse.Namespace) -> PlannedTrajectory | None:
    """Return the planned trajectory; raise `InputError` where it cannot be used."""
    if not arguments.trajectory:
        return None
    name, *numbers = arguments.trajectory
    places = _numbers("--trajectory", numbers)
    return PlannedTrajectory(_text("--trajectory", name, LONGEST_NAME), places[:3], places[3:])


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
