"""`rastrainer simulate-cohort`: a study of virtual trainees whose skills are known."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from rastrainer.cohort.outcome_model import OutcomeModel
from rastrainer.cohort.population import ModeEffect, Population
from rastrainer.cohort.rejection_rates import rejection_rates
from rastrainer.commands.text_table import text_table
from rastrainer.errors import InputError
from rastrainer.experiment.study_protocol import StudyProtocol, read_study_protocol
from rastrainer.protocol import Mode
from rastrainer.scoring import TASK_REFERENCES
from rastrainer.scripted_trainee import Skill
from rastrainer_simulator.assets import asset_path

SHIPPED_PROTOCOL = ("studies", "published-protocol.json")
TYPICAL_FLE_MM = 1.5
MOST_TRAINEES = 100_000


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "simulate-cohort",
        help="simulate a study of virtual trainees with known skills",
        description=(
            "Play a study's trials with seeded virtual trainees, faster than real time, on all "
            "cores, and store them like a real study (study.db, for rastrainer report). With "
            "--power, draw many studies from a model of times and errors instead, without the "
            "simulator, and print how often the tests find the effect."
        ),
    )
    parser.add_argument("--trainees", type=int, default=20, metavar="N")
    parser.add_argument("--protocol", type=Path, metavar="FILE", help="default: the published one")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("-o", "--output", type=Path, metavar="DIR", help="an empty folder")
    parser.add_argument("--records", action="store_true", help="write the journals too")
    parser.add_argument("--power", type=int, metavar="STUDIES", help="draw so many studies")
    _add_skills(parser)
    _add_engine(parser)
    parser.set_defaults(run=run)


def _add_skills(parser: argparse.ArgumentParser) -> None:
    skills = parser.add_argument_group("what is true of the trainees")
    skills.add_argument("--speed", type=float, default=120.0, metavar="MM/S")
    skills.add_argument("--aim", type=float, default=0.8, metavar="MM", help="SD along each axis")
    skills.add_argument("--hmd-speed", type=float, default=1.0, metavar="FACTOR")
    skills.add_argument("--hmd-aim", type=float, default=1.0, metavar="FACTOR")
    skills.add_argument("--spread", type=float, default=0.15, help="between trainees")
    skills.add_argument("--learning", type=float, default=0.15, metavar="EXPONENT")


def _add_engine(parser: argparse.ArgumentParser) -> None:
    engine = parser.add_argument_group("where it runs")
    engine.add_argument("--engine", choices=("processes", "dask"), default="processes")
    engine.add_argument("--workers", type=int, metavar="N", help="default: one a core")
    engine.add_argument("--address", metavar="URL", help="of a Dask scheduler")
    engine.add_argument("--step", type=float, default=0.05, metavar="S", help="of the simulation")
    engine.add_argument("--scenario", type=Path, metavar="DIR")


def run(arguments: argparse.Namespace) -> int:
    """Simulate the cohort and return the exit status.

    Raises:
        InputError: an argument, the protocol or the folder cannot be used.
    """
    if not 2 <= arguments.trainees <= MOST_TRAINEES or arguments.seed < 0:
        raise InputError(f"A cohort has 2 to {MOST_TRAINEES} trainees, and its seed is 0 or above.")
    protocol = read_study_protocol(arguments.protocol or asset_path(*SHIPPED_PROTOCOL))
    if arguments.power is not None:
        print(_power(protocol, arguments))
        return 0
    if arguments.output is None:
        raise InputError("Say where the study shall be stored, with -o.")
    _check_playing(arguments)
    _play(protocol, arguments)
    return 0


def _check_playing(arguments: argparse.Namespace) -> None:
    if not 5 <= arguments.speed <= 450 or not 0 <= arguments.aim <= 3:
        raise InputError("The speed must be from 5 to 450 mm/s, the aim's SD from 0 to 3 mm.")
    if not 0.002 <= arguments.step <= 0.1:
        raise InputError("A step of the simulation must be from 0.002 to 0.1 s.")
    if arguments.workers is not None and not 1 <= arguments.workers <= 1024:
        raise InputError("There must be 1 to 1024 workers.")


def _play(protocol: StudyProtocol, arguments: argparse.Namespace) -> None:
    # Only here: the robot and the scenario take time to import.
    from rastrainer_simulator.cohort.cohort import simulate_cohort
    from rastrainer_simulator.cohort.play import PlaySettings

    trials = arguments.trainees * len(protocol.modes) * len(protocol.tasks) * protocol.repetitions

    def tell(count: int) -> None:
        if sys.stderr.isatty():
            print(f"  {count} of {trials} trials", end="\r", file=sys.stderr, flush=True)

    result = simulate_cohort(
        protocol,
        _population(arguments),
        arguments.trainees,
        arguments.seed,
        arguments.output,
        PlaySettings(arguments.scenario, arguments.step),
        arguments.records,
        arguments.engine,
        arguments.workers,
        arguments.address,
        tell,
    )
    faster = result.simulated_s / result.seconds
    print(
        f"{arguments.output}: {result.played} trials in {result.seconds:.0f} s, "
        f"{faster:.0f} times faster than real time; {result.stuck} got stuck and are left out"
    )


def _population(arguments: argparse.Namespace) -> Population:
    return Population(
        skill=Skill(speed_mm_s=arguments.speed, aim_sd_mm=arguments.aim),
        speed_spread=arguments.spread,
        aim_spread=arguments.spread,
        learning=arguments.learning,
        modes={Mode.HMD.value: ModeEffect(arguments.hmd_speed, arguments.hmd_aim)},
    )


def _power(protocol: StudyProtocol, arguments: argparse.Namespace) -> str:
    if not 10 <= arguments.power <= 100_000 or len(protocol.modes) != 2:
        raise InputError("Power needs 10 to 100000 studies of a protocol with two modes.")
    if not (0.1 <= arguments.hmd_speed <= 10 and 0.1 <= arguments.hmd_aim <= 10):
        raise InputError("The effects of a mode must be factors from 0.1 to 10.")
    fallback = TASK_REFERENCES["task-1"]
    tasks = protocol.tasks * protocol.repetitions
    model = OutcomeModel(
        task_times_s=[TASK_REFERENCES.get(task, fallback).time_s for task in tasks],
        task_fle_mm=[TYPICAL_FLE_MM] * len(tasks),
        trainee_time_sd=arguments.spread,
        trainee_fle_sd=arguments.spread,
        learning=arguments.learning,
        mode_time={Mode.HMD.value: 1 / arguments.hmd_speed},
        mode_fle={Mode.HMD.value: arguments.hmd_aim},
    )
    modes = sorted(protocol.modes)
    rates = rejection_rates(model, arguments.trainees, modes, arguments.power, arguments.seed)
    rows = [
        [
            r.outcome,
            f"{r.true_difference:+.4f}",
            f"{100 * r.t_test:.1f} %",
            f"{100 * r.wilcoxon:.1f} %",
            f"{100 * r.coverage:.1f} %",
        ]
        for r in rates
    ]
    header = ["outcome", "true difference", "t-test p < .05", "Wilcoxon p < .05", "95 % covers"]
    return (
        f"{arguments.power} studies of {arguments.trainees} trainees, {modes[1]} minus {modes[0]}, "
        "drawn from a model of outcomes (not played)\n" + text_table(header, rows)
    )
