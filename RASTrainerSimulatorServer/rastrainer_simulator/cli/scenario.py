"""`rastrainer scenario`: make, check and share scenarios."""

from __future__ import annotations

import argparse
import signal
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.writing import write_json
from rastrainer.head.mesh import RAS_LIMIT_MM, read_head_mesh
from rastrainer.json_checks import accepted, text
from rastrainer.json_records import record_to_json
from rastrainer.number_text import fixed
from rastrainer.procedure.checks import MeasuredProcedure
from rastrainer.procedure.plan import read_procedure
from rastrainer.scenario.library import list_scenarios, unpack
from rastrainer.scenario.points import PlannedTarget, PlannedTrajectory
from rastrainer.scenario.scenario import load_scenario
from rastrainer.scenario.setup import SetUp, read_setup
from rastrainer.scenario.writer import read_draft, require_new, scenario_name
from rastrainer.work_progress import print_progress, print_warning
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.authoring.export import draw_face_removal, pack_for_sharing
from rastrainer_simulator.authoring.landmarks import (
    check_on_planned_head,
    read_placed_landmarks,
    write_proposal,
)
from rastrainer_simulator.authoring.make import (
    ScenarioOptions,
    check_options,
    copy_with_plan,
    head_process,
    make_scenario,
    without_tasks,
)
from rastrainer_simulator.authoring.planning_setup import PlanningSetup
from rastrainer_simulator.authoring.procedure_plan import measure_procedure, skull_of
from rastrainer_simulator.authoring.scenario_check import check_scenario
from rastrainer_simulator.cli.printing import aligned
from rastrainer_simulator.rendering.picture import draw_preview

ALL_RIGHT = "Set-up, plan and fiducials can be used."


def build(arguments: argparse.Namespace) -> int:
    _clean_up_when_terminated()
    options = options_of(arguments, arguments.volume.name)
    require_new(arguments.output)
    head_options = head_arguments(arguments)
    head_options += ["--no-skull"] if arguments.no_skull or arguments.check else []
    head_options += ["--no-volume"] if arguments.no_volume or arguments.check else []
    with head_process(arguments.volume, head_options) as process:
        head = process.head(lambda step, share: print_progress(step, 0.5 * share), print_warning)
        if arguments.check:
            check_options(head, options, print_progress, print_warning)
            print(ALL_RIGHT)
            return 0
        scenario = make_scenario(
            head,
            options,
            arguments.output,
            lambda step, share: print_progress(step, 0.5 + 0.5 * share),
            None if arguments.no_skull else process.whole,
            print_warning,
        )
    print(
        f"{scenario.title} is in {arguments.output}; load it with: rastrainer simulator "
        f"--scenario {arguments.output}"
    )
    return 0


def propose_tasks(arguments: argparse.Namespace) -> int:
    _clean_up_when_terminated()
    options, draft = options_of(arguments, "unknown"), read_draft(arguments.draft)
    if arguments.check:
        check_options(draft, options, print_progress, print_warning)
        print(ALL_RIGHT)
    else:
        make_scenario(draft, options, arguments.output, print_progress, warn=print_warning)
    return 0


def preview(arguments: argparse.Namespace) -> int:
    options = [*head_arguments(arguments), "--no-skull", "--no-volume"]
    with head_process(arguments.volume, options) as process:
        draft = process.head(print_progress, print_warning)
    scenario = without_tasks(draft, ScenarioOptions("Preview", "none", "none"))
    draw_preview(arguments.png, scenario, draft.head)
    print(draft.method)
    return 0


def check(arguments: argparse.Namespace) -> int:
    wrong = check_scenario(arguments.dir)
    print("\n".join(wrong) or f"{arguments.dir} is as a scenario must be.")
    return 1 if wrong else 0


def measure_lines(arguments: argparse.Namespace) -> int:
    scenario = load_scenario(arguments.dir)
    skull_of(scenario)
    planning = PlanningSetup(scenario, read_head_mesh(scenario.head))
    procedures = scenario.procedures
    if arguments.procedure is not None:
        procedures = (read_procedure(arguments.procedure),)
    measured = [measure_procedure(planning, each) for each in procedures]
    print("\n\n".join(map(_lines_text, measured)) or "The scenario has no procedure.")
    if arguments.json is not None:
        write_json(arguments.json, [record_to_json(each, with_defaults=True) for each in measured])
    return 1 if any(each.wrong for each in measured) else 0


def _lines_text(measured: MeasuredProcedure) -> str:
    """Return the table of a procedure's lines, and its errors."""
    header = [
        *("line", "length (mm)", "angle to the skull (°)", "nearest no-go structure (mm)"),
        *("nearest other line (mm)", "reach"),
    ]
    table = [header]
    for line in measured.lines:
        angle, near, other = line.skull_angle_deg, line.nearest_no_go, line.nearest_line_mm
        table.append(
            [
                line.name,
                fixed(line.length_mm, 1),
                "–" if angle is None else fixed(angle, 1),
                f"{fixed(line.no_go_mm[near], 1)} {near}" if near else "–",
                "–" if other is None else f"{fixed(other, 1)} {line.nearest_line}",
                {True: "yes", False: "no", None: "not tried"}[line.is_held],
            ]
        )
    title = f"{measured.title} ({measured.procedure})"
    return "\n".join([title, *aligned(table, len(header)), *measured.wrong])


def copy(arguments: argparse.Namespace) -> int:
    scenario = copy_with_plan(
        arguments.dir,
        arguments.output,
        print_warning,
        procedure=arguments.procedure and read_procedure(arguments.procedure),
        landmarks=arguments.landmarks and read_placed_landmarks(arguments.landmarks),
        **plan_of(arguments),
    )
    print(f"{scenario.title} is in {arguments.output}.")
    return 0


def check_landmarks(arguments: argparse.Namespace) -> int:
    if arguments.propose:
        print(" ".join(write_proposal(arguments.dir, arguments.mrk_json)))
        return 0
    landmarks, scenario = read_placed_landmarks(arguments.mrk_json), load_scenario(arguments.dir)
    planning = PlanningSetup(scenario, read_head_mesh(scenario.head))
    wrong = check_on_planned_head(planning, landmarks)
    print(" ".join(wrong) or "The landmarks can be used.")
    return 1 if wrong else 0


def pack(arguments: argparse.Namespace) -> int:
    package = arguments.zip
    if arguments.picture is not None:
        sentence = draw_face_removal(arguments.dir, arguments.picture)
        print(f"{arguments.picture}\n{sentence}")
        return 0
    if not (arguments.keep_face or arguments.yes):
        _ask_about_face(arguments.dir)
    taken = pack_for_sharing(arguments.dir, package, arguments.keep_face, arguments.keep_names)
    print(f"{package} ({package.stat().st_size / 1e6:.1f} MB)")
    print(taken)
    return 0


def _ask_about_face(folder: Path) -> None:
    """Ask on the terminal whether the picture shows that the face would be gone."""

    if not sys.stdin.isatty():
        raise InputError(
            "Whether the face is gone is for you to judge: draw the head before and after with "
            "--picture PNG, look at it, and repeat with --yes."
        )
    with tempfile.TemporaryDirectory() as temporary:
        picture = Path(temporary) / "before-and-after.png"
        sentence = draw_face_removal(folder, picture)
        print(f"{picture}\n{sentence}")
        answer = input("Is the face gone? Only then write the zip file. [y/N] ")
    if answer.strip().lower() not in ("y", "yes"):
        raise InputError("Nothing was written.")


def unpack_zip(arguments: argparse.Namespace) -> int:
    print(unpack(arguments.zip, arguments.library))
    return 0


def list_all(arguments: argparse.Namespace) -> int:
    for entry in list_scenarios([asset_path("scenarios"), arguments.library]):
        print(f"{entry.name:<24}{entry.problem or entry.title}  ({entry.folder})")
    return 0


def _clean_up_when_terminated() -> None:
    """Exit like an error on SIGTERM, by which Slicer cancels, so that everything is cleaned up."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))


def options_of(arguments: argparse.Namespace, source: str) -> ScenarioOptions:
    """Return the options of a command line; `source` is the default for its source."""
    return ScenarioOptions(
        source=accepted(text(4000), arguments.source or source, "--source"),
        license=accepted(text(4000), arguments.license, "--license"),
        setup=read_setup(arguments.setup) if arguments.setup else SetUp(),
        task_files=tuple(arguments.tasks or ()),
        seed=arguments.seed,
        **plan_of(arguments),
    )


def plan_of(arguments: argparse.Namespace) -> dict[str, Any]:
    """Return title, targets and trajectory; a scenario's name can be made of the title."""
    title = arguments.title or arguments.output.absolute().name
    scenario_name(accepted(text(80), title, "--title"))
    given = arguments.trajectory
    return {
        "title": title,
        "targets": tuple(PlannedTarget(*_named("--target", words)) for words in arguments.target),
        "trajectory": PlannedTrajectory(*_named("--trajectory", given)) if given else None,
    }


def _named(option: str, words: list[str]) -> tuple[Any, ...]:
    """Return a name and points, each (3,) float, RAS mm, of an option's words."""
    name, *numbers = words
    try:
        points = np.array([float(number) for number in numbers]).reshape(-1, 3)
    except ValueError:
        raise InputError(f"{option} needs numbers after its name, RAS mm.") from None
    if not (np.abs(points) <= RAS_LIMIT_MM).all():
        raise InputError(f"{option} must be within ±{RAS_LIMIT_MM:g} mm.")
    return accepted(text(60), name, option), *points


def head_arguments(arguments: argparse.Namespace) -> list[str]:
    """Return how the head is found, for the process that finds it."""
    named = ("threshold", "cut", "orientation")
    given = ((name, getattr(arguments, name)) for name in named)
    return [f"--{name}={value}" for name, value in given if value is not None]
