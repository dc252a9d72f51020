"""`rastrainer scenario`: make, check and share scenarios."""

from __future__ import annotations

import argparse
import signal
import sys
import tempfile
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.writing import write_json
from rastrainer.json_records import record_to_json
from rastrainer.procedure.plan import Procedure, read_procedure
from rastrainer.scenario.library import list_scenarios, unpack
from rastrainer.scenario.writer import require_new
from rastrainer.work_progress import print_progress, print_warning
from rastrainer_simulator.cli import arg
from rastrainer_simulator.cli.options import Subcommand
from rastrainer_simulator.cli.scenario_options import (
    HEAD_OPTIONS,
    LIBRARY,
    OPTIONS,
    OUTPUT,
    PLAN,
    head_arguments,
    options_of,
    procedure_option,
    targets_of,
    title_of,
    trajectory_of,
)

ALL_RIGHT = "Set-up, plan and fiducials can be used."


def _build(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.authoring.make import check_options, head_process, make_scenario

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


def _tasks(arguments: argparse.Namespace) -> int:
    from rastrainer.scenario.writer import read_draft
    from rastrainer_simulator.authoring.make import check_options, make_scenario

    _clean_up_when_terminated()
    options, draft = options_of(arguments, "unknown"), read_draft(arguments.draft)
    if arguments.check:
        check_options(draft, options, print_progress, print_warning)
        print(ALL_RIGHT)
    else:
        make_scenario(draft, options, arguments.output, print_progress, warn=print_warning)
    return 0


def _preview(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.authoring.make import ScenarioOptions, head_process, without_tasks
    from rastrainer_simulator.rendering.picture import draw_preview

    options = [*head_arguments(arguments), "--no-skull", "--no-volume"]
    with head_process(arguments.volume, options) as process:
        draft = process.head(print_progress, print_warning)
    scenario = without_tasks(draft, ScenarioOptions("Preview", "none", "none"))
    draw_preview(arguments.picture, scenario, draft.head)
    print(draft.method)
    return 0


def _check(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.authoring.scenario_check import check_scenario

    wrong = check_scenario(arguments.folder)
    print("\n".join(wrong) or f"{arguments.folder} is as a scenario must be.")
    return 1 if wrong else 0


def _lines(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.authoring.procedure_plan import line_table, measure_procedures

    measured = measure_procedures(arguments.folder, _procedure_of(arguments))
    print("\n".join(line_table(measured)))
    if arguments.json is not None:
        write_json(arguments.json, [record_to_json(each, with_defaults=True) for each in measured])
    return 1 if any(each.wrong for each in measured) else 0


def _plan(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.authoring.landmarks import read_placed_landmarks
    from rastrainer_simulator.authoring.make import copy_with_plan

    scenario = copy_with_plan(
        arguments.folder,
        title_of(arguments),
        arguments.output,
        targets_of(arguments),
        trajectory_of(arguments),
        print_warning,
        _procedure_of(arguments),
        None if arguments.landmarks is None else read_placed_landmarks(arguments.landmarks),
    )
    print(f"{scenario.title} is in {arguments.output}.")
    return 0


def _landmarks(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.authoring.landmarks import (
        check_placed_landmarks,
        read_placed_landmarks,
        write_proposal,
    )

    if arguments.propose:
        print(" ".join(write_proposal(arguments.folder, arguments.file)))
        return 0
    wrong = check_placed_landmarks(arguments.folder, read_placed_landmarks(arguments.file))
    print(" ".join(wrong) or "The landmarks can be used.")
    return 1 if wrong else 0


def _pack(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.authoring.export import draw_face_removal, pack_for_sharing

    package = arguments.package
    if arguments.picture is not None:
        sentence = draw_face_removal(arguments.folder, arguments.picture)
        print(f"{arguments.picture}\n{sentence}")
        return 0
    if not (arguments.keep_face or arguments.yes):
        _ask_about_face(arguments.folder)
    taken = pack_for_sharing(arguments.folder, package, arguments.keep_face, arguments.keep_names)
    print(f"{package} ({package.stat().st_size / 1e6:.1f} MB)")
    print(taken)
    return 0


def _ask_about_face(folder: Path) -> None:
    """Ask on the terminal whether the picture shows that the face would be gone."""
    from rastrainer_simulator.authoring.export import draw_face_removal

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


def _unpack(arguments: argparse.Namespace) -> int:
    print(unpack(arguments.package, arguments.library))
    return 0


def _list(arguments: argparse.Namespace) -> int:
    from rastrainer_simulator.assets import asset_path

    for entry in list_scenarios([asset_path("scenarios"), arguments.library]):
        print(f"{entry.name:<24}{entry.problem or entry.title}  ({entry.folder})")
    return 0


def _procedure_of(arguments: argparse.Namespace) -> Procedure | None:
    return None if arguments.procedure is None else read_procedure(arguments.procedure)


def _clean_up_when_terminated() -> None:
    """Exit like an error on SIGTERM, by which Slicer cancels, so that everything is cleaned up."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))


FOLDER = arg.path("folder", "DIR")
ACTIONS = (
    Subcommand(
        "build",
        "make a scenario of a volume",
        _build,
        (
            arg.path("volume", "VOLUME", "NRRD, NIfTI or DICOM folder"),
            *HEAD_OPTIONS,
            arg.flag("--no-skull", "leave the skull out"),
            arg.flag("--no-volume", "leave the images out"),
            *OPTIONS,
        ),
    ),
    Subcommand(
        "tasks",
        "propose tasks on a head that was made elsewhere",
        _tasks,
        (arg.path("draft", "DRAFT", "folder with the head's draft"), *OPTIONS),
    ),
    Subcommand(
        "preview",
        "draw the head in a volume, to adjust it",
        _preview,
        (arg.path("volume", "VOLUME"), arg.path("picture", "PNG"), *HEAD_OPTIONS),
    ),
    Subcommand("check", "list the errors of a scenario; status 1 if any", _check, (FOLDER,)),
    Subcommand(
        "plan",
        "copy a scenario with other targets or trajectory",
        _plan,
        (
            FOLDER,
            *OUTPUT,
            *PLAN,
            procedure_option("added, or in the place of the one of the same name"),
            arg.path(
                "--landmarks",
                "MRK_JSON",
                "placed landmarks, in the order of touching, in the place of the scenario's own",
            ),
        ),
    ),
    Subcommand(
        "landmarks",
        "check placed landmarks on a head, or propose them; status 1 if wrong",
        _landmarks,
        (
            FOLDER,
            arg.path("file", "MRK_JSON"),
            arg.flag("--propose", "write a proposal to MRK_JSON"),
        ),
    ),
    Subcommand(
        "lines",
        "measure the planned lines of procedures; status 1 if any is wrong",
        _lines,
        (
            FOLDER,
            procedure_option("measured in the place of the scenario's own"),
            arg.path("--json", "FILE", "write everything there, too"),
        ),
    ),
    Subcommand(
        "pack",
        "write a scenario as one zip file, without face, title and source",
        _pack,
        (
            FOLDER,
            arg.path("package", "ZIP"),
            arg.path("--picture", "PNG", "only draw the head before and after; write no zip file"),
            arg.flag("--yes", "the picture was looked at"),
            arg.flag("--keep-face", "the patient can then be recognized"),
            arg.flag("--keep-names", "title, name and source, too"),
        ),
    ),
    Subcommand(
        "unpack",
        "unpack a scenario into your library",
        _unpack,
        (arg.path("package", "ZIP"), LIBRARY),
    ),
    Subcommand("list", "list the available scenarios", _list, (LIBRARY,)),
)


COMMANDS = (
    Subcommand(
        "scenario",
        "make a scenario of a head MRI or CT, check, pack and list scenarios",
        description="Makes and checks scenarios. Not for clinical use.",
        actions=ACTIONS,
    ),
)
