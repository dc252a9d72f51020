"""Commands of virtual trainees: `rastrainer simulate-cohort` and `rastrainer calibrate`."""

from __future__ import annotations

import argparse
import math
import sys
from dataclasses import asdict

from rastrainer.errors import InputError
from rastrainer.number_text import significant
from rastrainer.protocol import Mode
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.protocol.study_protocol import StudyProtocol, mode_order
from rastrainer.trial.score_reference import score_reference
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli.printing import json_text, picked, text_table
from rastrainer_simulator.core.setup import DEFAULT_SCENARIO, load_setup
from rastrainer_simulator.virtual.calibration import calibrated
from rastrainer_simulator.virtual.cohort import simulate_cohort
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.outcome_model import OutcomeModel, rejection_rates
from rastrainer_simulator.virtual.play import PlaySettings
from rastrainer_simulator.virtual.population import ModeEffect, Population

SHIPPED_PROTOCOL = ("studies", "published-protocol.json")
TYPICAL_FLE_MM = 1.5
TRIAL_TIME_SD = 0.12
"""SD of the logarithm of drawn times besides the tempo: heads, paths and slips of the hand."""


def simulate(arguments: argparse.Namespace) -> int:
    protocol = StudyProtocol.read(arguments.protocol or asset_path(*SHIPPED_PROTOCOL))
    if arguments.power is not None:
        print(_power(protocol, arguments))
        return 0
    if arguments.output is None:
        raise InputError("Name the folder of the study with -o.")
    trials = arguments.trainees * len(protocol.modes) * len(protocol.tasks) * protocol.repetitions

    def show_progress(count: int) -> None:
        if sys.stderr.isatty():
            print(f"  {count} of {trials} trials", end="\r", file=sys.stderr, flush=True)

    try:
        result = simulate_cohort(
            *(protocol, _population(arguments), arguments.trainees, arguments.seed),
            *(arguments.output, PlaySettings(arguments.scenario, arguments.step)),
            arguments.records,
            arguments.workers,
            show_progress,
        )
    except KeyboardInterrupt:
        print(
            f"rastrainer: Interrupted. The trials played so far are stored in {arguments.output}; "
            "the same command resumes.",
            file=sys.stderr,
        )
        raise
    faster = result.simulated_s / result.seconds
    found = f"{result.found} trials were stored before; " if result.found else ""
    print(
        f"{arguments.output}: {found}{result.played} trials in {result.seconds:.0f} s, "
        f"{faster:.0f} times faster than real time; {result.stuck} got stuck and are left out"
    )
    return 0


def _population(arguments: argparse.Namespace) -> Population:
    effect = ModeEffect(arguments.hmd_speed, arguments.hmd_aim, tuple(arguments.hmd_bias))
    names = ("learning", "accuracy_learning", "interaction", "tempo_spread", "trade_off", "lapses")
    return Population(
        skill=Skill(speed_mm_s=arguments.speed, aim_sd_mm=arguments.aim),
        speed_spread=arguments.spread,
        aim_spread=arguments.spread,
        modes={Mode.HMD.value: effect},
        **picked(arguments, *names),
    )


def _power(protocol: StudyProtocol, arguments: argparse.Namespace) -> str:
    if len(protocol.modes) != 2:
        raise InputError("Power needs a protocol with two modes.")
    population = _population(arguments)
    scenario = load_scenario(arguments.scenario or asset_path(*DEFAULT_SCENARIO))
    times_s = [score_reference(scenario, task).time_s for task in protocol.tasks]
    times_s *= protocol.repetitions
    model = OutcomeModel(
        task_times_s=times_s,
        task_fle_mm=[TYPICAL_FLE_MM] * len(times_s),
        trainee_time_sd=population.speed_spread,
        trainee_fle_sd=population.aim_spread,
        interaction_sd=population.interaction,
        trial_time_sd=math.hypot(TRIAL_TIME_SD, population.tempo_spread),
        learning=population.learning,
        accuracy_learning=population.accuracy_learning,
        trade_off=population.trade_off,
        lapses=population.lapses or 0.0,
        carries_practice=True,
        mode_time={Mode.HMD.value: 1 / arguments.hmd_speed},
        mode_fle={Mode.HMD.value: arguments.hmd_aim},
    )
    modes = sorted(protocol.modes)
    orders = [mode_order(protocol, place) for place in range(arguments.trainees)]
    counts = arguments.power, arguments.seed
    rates = rejection_rates(model, arguments.trainees, modes, *counts, orders)
    rows = [
        [
            r.outcome,
            "–" if r.true_difference is None else significant(r.true_difference, 4, sign=True),
            *(f"{100 * share:.1f} %" for share in (r.t_test, r.holm, r.ranks)),
            "–" if r.coverage is None else f"{100 * r.coverage:.1f} %",
        ]
        for r in rates
    ]
    header = ["outcome", "true difference", "p < .05", "p (Holm) < .05", "rank test", "95 % covers"]
    order = "the same for all: practice is part of the difference"
    if len(set(orders)) > 1:
        order = "balanced: the effect of the period is separated"
    return (
        f"{arguments.power} studies of {arguments.trainees} trainees, {modes[1]} minus {modes[0]}, "
        f"drawn from a model of outcomes (not played)\norder of the modes {order}\n"
        + text_table(header, rows)
    )


def calibrate(arguments: argparse.Namespace) -> int:
    found = calibrated(load_setup(None), arguments.repeats)
    outside = [one.name for one in found if not one.holds]
    if arguments.json:
        print(json_text({"quantities": [asdict(one) for one in found], "outside": outside}))
    else:
        rows = [
            [
                f"{one.name}, {one.unit}".removesuffix(", "),
                significant(one.simulated),
                f"{one.least:g} to {one.most:g}",
                f"fitted by {one.fitted}" if one.fitted else "held out",
                "yes" if one.holds else "NO",
            ]
            for one in found
        ]
        print(text_table(["quantity", "simulated", "published", "", "in the range"], rows))
        print("\nPublished in:", *(f"  {one.name}: {one.source}" for one in found), sep="\n")
    return 1 if outside else 0
