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
from rastrainer.scenario.library import list_scenarios, unpack
from rastrainer.scenario.writer import require_new
from rastrainer.work_progress import print_progress, print_warning
from rastrainer_simulator.cli.scenario_options import (
    add_head_options,
    add_library,
    add_options,
    add_output,
    add_plan,
    add_procedure,
    head_arguments,
    options_of,
    procedure_of,
    targets_of,
    title_of,
    trajectory_of,
)

ALL_RIGHT = "Set-up, plan and fiducials can be used."


def add_parser(subparsers: argparse._SubParsersAction) -> None:
    """Add the subcommand to the parser of `rastrainer`."""
    parser = subparsers.add_parser(
        "scenario",
        help="make a scenario of a head MRI or CT, check, pack and list scenarios",
        description="Makes and checks scenarios. Not for clinical use.",
    )
    parts = parser.add_subparsers(title="what to do", required=True, metavar="ACTION")
    build = parts.add_parser("build", help="make a scenario of a volume")
    build.add_argument("volume", type=Path, metavar="VOLUME", help="NRRD, NIfTI or DICOM folder")
    add_head_options(build)
    build.add_argument("--no-skull", action="store_true", help="leave the skull out")
    build.add_argument("--no-volume", action="store_true", help="leave the images out")
    add_options(build)
    build.set_defaults(run=_build)
    tasks = parts.add_parser("tasks", help="propose tasks on a head that was made elsewhere")
    tasks.add_argument("draft", type=Path, metavar="DRAFT", help="folder with the head's draft")
    add_options(tasks)
    tasks.set_defaults(run=_tasks)
    preview = parts.add_parser("preview", help="draw the head in a volume, to adjust it")
    preview.add_argument("volume", type=Path, metavar="VOLUME")
    preview.add_argument("picture", type=Path, metavar="PNG")
    add_head_options(preview)
    preview.set_defaults(run=_preview)
    check = parts.add_parser("check", help="list the errors of a scenario; status 1 if any")
    check.add_argument("folder", type=Path, metavar="DIR")
    check.set_defaults(run=_check)
    plan = parts.add_parser("plan", help="copy a scenario with other targets or trajectory")
    plan.add_argument("folder", type=Path, metavar="DIR")
    add_output(plan)
    add_plan(plan)
    add_procedure(plan, "added, or in the place of the one of the same name")
    plan.set_defaults(run=_plan)
    plan.add_argument(
        "--landmarks",
        type=Path,
        metavar="MRK_JSON",
        help="placed landmarks, in the order of touching, in the place of the scenario's own",
    )
    landmarks = parts.add_parser(
        "landmarks", help="check placed landmarks on a head, or propose them; status 1 if wrong"
    )
    landmarks.add_argument("folder", type=Path, metavar="DIR")
    landmarks.add_argument("file", type=Path, metavar="MRK_JSON")
    landmarks.add_argument("--propose", action="store_true", help="write a proposal to MRK_JSON")
    landmarks.set_defaults(run=_landmarks)
    lines = parts.add_parser(
        "lines", help="measure the planned lines of procedures; status 1 if any is wrong"
    )
    lines.add_argument("folder", type=Path, metavar="DIR")
    add_procedure(lines, "measured in the place of the scenario's own")
    lines.add_argument("--json", type=Path, metavar="FILE", help="write everything there, too")
    lines.set_defaults(run=_lines)
    packing = parts.add_parser(
        "pack", help="write a scenario as one zip file, without face, title and source"
    )
    packing.add_argument("folder", type=Path, metavar="DIR")
    packing.add_argument("package", type=Path, metavar="ZIP")
    packing.add_argument(
        "--picture",
        type=Path,
        metavar="PNG",
        help="only draw the head before and after; write no zip file",
    )
    packing.add_argument("--yes", action="store_true", help="the picture was looked at")
    packing.add_argument(
        "--keep-face", action="store_true", help="the patient can then be recognized"
    )
    packing.add_argument("--keep-names", action="store_true", help="title, name and source, too")
    packing.set_defaults(run=_pack)
    unpacking = parts.add_parser("unpack", help="unpack a scenario into your library")
    unpacking.add_argument("package", type=Path, metavar="ZIP")
    add_library(unpacking)
    unpacking.set_defaults(run=_unpack)
    listing = parts.add_parser("list", help="list the available scenarios")
    add_library(listing)
    listing.set_defaults(run=_list)


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

    measured = measure_procedures(arguments.folder, procedure_of(arguments))
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
        procedure_of(arguments),
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


def _clean_up_when_terminated() -> None:
    """Exit like an error on SIGTERM, by which Slicer cancels, so that everything is cleaned up."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
