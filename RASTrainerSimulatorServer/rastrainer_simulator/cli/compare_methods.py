"""`rastrainer compare-methods [STUDY]`: the same trials registered by every method."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.writing import make_empty_folder, write_text
from rastrainer.head.mesh import read_head_mesh
from rastrainer.number_text import fixed
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.study.database.database import StudyPlace
from rastrainer.study.database.study import Study
from rastrainer.study.tidy_csv import csv_text
from rastrainer.trial.score_reference import region_of
from rastrainer.trial.touch_registration import GivenPoints
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli.printing import json_text, text_table
from rastrainer_simulator.report.charts import grouped_bars
from rastrainer_simulator.virtual.method_trials import (
    METHODS,
    PUBLISHED_NOISE,
    MethodResult,
    MethodStudy,
    mean_of,
    points_of_trial,
    register_by,
)

Found = Mapping[RegistrationMethod, Sequence[tuple[str, MethodResult]]]
"""The trials' names and results, by method."""
HEADER = (
    *("Method", "trials", "residual (mm)", "expected TRE (mm)", "interval (mm)"),
    *("true TRE (mm)", "interval holds it"),
)
NOTE = (
    "Residuals and errors are root mean squares over trials and targets, ends of intervals medians."
    " Residuals of different methods are of different points: they do not show which is better."
)


def compare_methods(arguments: argparse.Namespace) -> int:
    folder = arguments.scenario or asset_path("scenarios", "colin27")
    scenario = load_scenario(folder)
    if arguments.output is not None:
        make_empty_folder(arguments.output)
    notes: list[str] = [NOTE]
    if arguments.study is None:
        found = _simulated(arguments, scenario, notes)
    else:
        found = _played(arguments.study, scenario, notes)
    if not any(found.values()):
        raise InputError(f"No trial in {arguments.study} can be registered on {scenario.name}.")
    methods = compared(found)
    text = "\n".join([comparison_text(methods), "", *notes])
    values = {"scenario": scenario.name, "methods": methods, "notes": notes}
    if arguments.output is not None:
        as_json = json_text(values)
        write_text(arguments.output / "methods.txt", text + "\n")
        write_text(arguments.output / "methods.json", as_json + "\n")
        write_text(arguments.output / "methods.csv", comparison_csv(found))
        write_text(arguments.output / "methods.svg", picture(found))
    print(json_text(values) if arguments.json else text)
    return 0


def _simulated(arguments: argparse.Namespace, scenario: Scenario, notes: list[str]) -> Found:
    task = arguments.task or scenario.tasks[-1].name
    scenario.task(task)
    trials = MethodStudy(scenario, task, arguments.skin_shift, arguments.indentation)
    possible = trials.possible()
    left_out = [method.value for method in METHODS if method not in possible]
    if left_out:
        notes.append(
            f"The scenario has {len(scenario.landmarks)} landmarks, too few for "
            f"{', '.join(left_out)}: add them to its scenario.json."
        )
    notes.append(
        f"Simulated: skin shift {arguments.skin_shift:g} mm RMS, indentation "
        f"{arguments.indentation:g} mm; error of a point, mm: "
        + ", ".join(f"{method.value} {PUBLISHED_NOISE[method]:g}" for method in possible)
        + "."
    )
    seeds = range(arguments.seed, arguments.seed + arguments.trials)
    return {m: [(str(seed), trials.trial(m, seed)) for seed in seeds] for m in possible}


def _played(place: StudyPlace, scenario: Scenario, notes: list[str]) -> Found:
    mesh, targets = read_head_mesh(scenario.head), region_of(scenario).targets
    found: dict[RegistrationMethod, list[tuple[str, MethodResult]]] = {}
    others = 0
    with Study.open_for_reading(place) as opened:
        everyone = opened.trainees(archived=None)
        trials = [trial for one in everyone for trial in opened.history(one.pseudonym)]
    for trial in trials:
        if trial.record.scenario != scenario.name:
            others += 1
            continue
        pose = None if trial.truth is None else trial.truth.matrix
        for points in points_of_trial(GivenPoints.of_record(trial.record), scenario):
            result = register_by(points, mesh, targets, pose)
            found.setdefault(points.method, []).append((trial.record.trial_id, result))
    if others:
        notes.append(
            f"Left out: {others} trials of other scenarios than {scenario.name}; give theirs with "
            "--scenario."
        )
    return found


def compared(found: Found) -> dict[str, dict[str, Any]]:
    """Return what each method reached, by its name; unknown values are None."""
    methods = {}
    for method, trials in found.items():
        results = [result for _, result in trials]
        residual, expected, true, held = mean_of(results)
        ends = np.median([e.interval_mm for one in results for e in one.errors], axis=0)
        methods[method.value] = {
            "trials": len(results),
            "residual_mm": residual,
            "expected_tre_mm": expected,
            "interval_mm": ends.tolist(),
            "true_tre_mm": true,
            "interval_holds_share": held,
            "warned_trials": sum(bool(result.warnings) for result in results),
        }
    return methods


def comparison_text(methods: Mapping[str, Mapping[str, Any]]) -> str:
    rows = []
    for name, found in methods.items():
        low, high = found["interval_mm"]
        true, held = found["true_tre_mm"], found["interval_holds_share"]
        rows.append(
            [
                *(name, str(found["trials"])),
                *(fixed(found[key], 2) for key in ("residual_mm", "expected_tre_mm")),
                f"{fixed(low, 2)} to {fixed(high, 2)}",
                "unknown" if true is None else fixed(true, 2),
                "–" if held is None else f"{fixed(100 * held, 0)} %",
            ]
        )
    return text_table(HEADER, rows)


def comparison_csv(found: Found) -> str:
    """Return one row for each trial, method and target."""
    header = (
        *("trial", "method", "target", "points", "residual_mm", "expected_tre_mm"),
        *("interval_low_mm", "interval_high_mm", "true_tre_mm", "warnings"),
    )
    rows = []
    for method, trials in found.items():
        for name, result in trials:
            true = [""] * len(result.errors) if result.true_mm is None else result.true_mm.tolist()
            codes = " ".join(warning.code for warning in result.warnings)
            for target, error in enumerate(result.errors):
                numbers = [result.residual_mm, error.expected_mm, *error.interval_mm, true[target]]
                first = [name, method.value, target + 1, result.points]
                rows.append([*first, *numbers, codes])
    return csv_text(header, rows)


def picture(found: Found) -> str:
    """Return expected and true TRE by method as SVG, as the report draws modes by task."""
    results = [[result for _, result in trials] for trials in found.values()]
    expected = [tuple(e.expected_mm for one in own for e in one.errors) for own in results]
    known = [[one.true_mm for one in own if one.true_mm is not None] for own in results]
    true = [tuple(float(value) for errors in own for value in errors) for own in known]
    series = [("expected TRE", "#0b6fa4", expected), ("true TRE", "#d1661b", true)]
    names = [method.value for method in found]
    return grouped_bars("Target registration error (mm)", names, series, "method")
