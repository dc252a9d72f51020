"""`rastrainer demo`: simulator, Slicer's side and a virtual trainee play two trials.

After the touches of the second one, two electrodes are placed by its registration.

Each is a separate process; they communicate by OpenIGTLink. What Slicer's side has written is
summarized.
"""

from __future__ import annotations

import argparse
import contextlib
import importlib.util
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError, RASTrainerError
from rastrainer.files.writing import write_text
from rastrainer.head.mesh import read_head_mesh
from rastrainer.igtl.client import Client
from rastrainer.protocol import DEFAULT_HOST, FIDUCIAL_COUNT, TRIAL_RUN, Proximity
from rastrainer.python_environment import python_command
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.study.database.study import STUDY_FILE, Study
from rastrainer.trial.ctps import CTPS_WARNING
from rastrainer.trial.procedure_outcome import procedure_outcome
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.setup import DEFAULT_SCENARIO

TASKS = (TRIAL_RUN, "task-1")
PROCEDURES = {"task-1": "dbs"}
"""The procedure after the touches of a task."""
TRAINEE = "virtual-01"
TOUCHES, FIDUCIALS = "touches.csv", "fiducials.csv"
BAR_WIDTH = 30
SLICER_TIMEOUT_S = 600.0


def play_demo(arguments: argparse.Namespace) -> int:
    """Play the trial run and Task 1, write the results into a folder, and print a summary."""
    if importlib.util.find_spec("slicer") is None:
        raise InputError(
            "The demo needs slicer-core, which plays the part of 3D Slicer: install it by "
            f'{sys.executable} -m pip install "rastrainer[slicer]"'
        )
    started, seed, speed = time.monotonic(), arguments.seed, arguments.speed
    output = arguments.output.absolute()
    move_aside(output)
    output.mkdir(parents=True)
    with Study.open(output / STUDY_FILE) as study:
        # Reports and exports need the consent to research.
        study.create_trainee(TRAINEE, consent=True)
    scenario = load_scenario(asset_path(*DEFAULT_SCENARIO))
    log = output / "slicer.log"
    with _simulator(output, seed, speed) as port:
        # Slicer's side without Slicer, which ends when it has stored all trials.
        words = ["rastrainer_headless.main", "--port", str(port), "--output", str(output)]
        words += ["--assets", str(asset_path()), "--trials", str(len(TASKS))]
        with _process(words, log, None) as slicer:
            state, record = _play(port, scenario, seed, speed)
            print("Slicer's side registers, scores, stores and draws ...", flush=True)
            try:
                status = slicer.wait(SLICER_TIMEOUT_S)
            except subprocess.TimeoutExpired:
                status = None
    if status != 0:
        raise RASTrainerError(f"Slicer's side did not finish its work; see {log}.")
    lines = (output / "results.jsonl").read_text(encoding="utf-8").splitlines()
    trials = [json.loads(line) for line in lines]
    head_to_world = np.reshape(trials[-1]["truth"]["headToWorld"], (4, 4))
    _draw_pictures(output, scenario, state, record, head_to_world)
    task = scenario.task(record.task)
    fiducials = zip(task.labels, task.fiducials.tolist(), strict=True)
    touches = ((point.label, point.position_mm) for point in record.points)
    for name, points in ((TOUCHES, touches), (FIDUCIALS, fiducials)):
        rows = (",".join(map(str, (label, *place))) for label, place in points)
        write_text(output / name, "\n".join(["label,x,y,z", *rows, ""]))
    for trial in trials:
        print("\n" + trial_summary(trial, scenario.task(trial["record"]["task"]).title))
    print("\n" + procedure_summary(record, scenario, head_to_world))
    written = ", ".join(sorted(path.name for path in output.iterdir()))
    print(f"\nWritten to {output} in {time.monotonic() - started:.0f} s: {written}.")
    return 0


def move_aside(folder: Path) -> None:
    """Rename a file, or a folder that holds something, to the first free `name-1`, `name-2` …"""
    if not folder.exists() or (folder.is_dir() and not any(folder.iterdir())):
        return
    number = 1
    while (aside := folder.with_name(f"{folder.name}-{number}")).exists():
        number += 1
    folder.rename(aside)
    print(f"The results that were in {folder} are now in {aside}.")


@contextlib.contextmanager
def _simulator(output: Path, seed: int, speed: float) -> Iterator[int]:
    """Run the simulator on a free port, which is yielded."""
    words = ["rastrainer_simulator.cli.main", "simulator", "--port", "0", "--seed", str(seed)]
    words += ["--speed", str(speed), "--records", str(output / "records")]
    log = output / "simulator.log"
    with _process(words, log, subprocess.PIPE) as process:
        assert process.stdout is not None  # It is a pipe.
        line = process.stdout.readline()
        if "ready" not in line:
            raise RASTrainerError(f"The simulator did not start; see {log}.")
        yield int(line.rsplit(":", 1)[1])


@contextlib.contextmanager
def _process(words: list[str], log: Path, stdout: int | None) -> Iterator[subprocess.Popen]:
    """Run a module with its arguments, `words`, and terminate it at the end."""
    with log.open("w") as file:
        out = file if stdout is None else stdout
        process = subprocess.Popen(python_command(*words), stdout=out, stderr=file, text=True)
        try:
            yield process
        finally:
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _play(
    port: int, scenario: Scenario, seed: int, speed: float
) -> tuple[dict[str, Any], TrialRecord]:
    """Play the tasks; return the state at the last touch, and the record with the procedure."""
    from rastrainer_simulator.virtual.scripted_trial import play_procedure, play_trial, send_hello

    with Client(DEFAULT_HOST, port) as client:
        send_hello(client, "scripted trainee")
        for number, name in enumerate(TASKS):
            title = scenario.task(name).title
            print(f"{TRAINEE} plays {title} ({speed:g} times faster than real time)")
            procedure = PROCEDURES.get(name, "")
            trial_id, state = play_trial(
                *(client, scenario, name, TRAINEE, seed + number),
                on_progress=_progress_bar(title),
                procedure=procedure,
            )
            print()
            if procedure:
                print(scenario.procedure(procedure).title, flush=True)
                record = play_procedure(
                    *(client, scenario, trial_id),
                    on_progress=lambda done: print(f"  {done}", flush=True),
                )
    return state, record


def _progress_bar(title: str) -> Callable[[dict[str, Any]], None]:
    """Return a function that shows how many points are touched, whenever that changes."""
    shown = ""

    def show(state: dict[str, Any]) -> None:
        nonlocal shown
        point = state["nextPoint"]
        touched = FIDUCIAL_COUNT if point is None else int(point) - 1
        filled = BAR_WIDTH * touched // FIDUCIAL_COUNT
        bar = "█" * filled + "·" * (BAR_WIDTH - filled)
        line = f"  {title:<10} {bar} {touched:2d}/{FIDUCIAL_COUNT} touched"
        if line != shown:
            shown = line
            print(line, end="\r" if sys.stdout.isatty() else "\n", flush=True)

    return show


def _draw_pictures(
    output: Path,
    scenario: Scenario,
    state: dict[str, Any],
    record: TrialRecord,
    head_to_world: np.ndarray,
) -> None:
    """Draw the arm and the head at the last touch, and the procedure's lines in the head."""
    from rastrainer_simulator.rendering.picture import looks_of, posed, render_picture
    from rastrainer_simulator.rendering.procedure_picture import draw_procedure, procedure_lines
    from rastrainer_simulator.robot.model import load_robot
    from rastrainer_simulator.scene.scene_glb import scene_nodes

    robot = load_robot()
    task = scenario.task(record.task)
    head = read_head_mesh(scenario.head)
    render_picture(
        output / "robot.png",
        scene_nodes(scenario, robot, head, task),
        posed(robot, state["q"], head_to_world, head),
        looks_of(task.labels, proximity=Proximity(state["proximity"])),
        scenario.cameras["far"],
        inset=scenario.cameras["close-up"],
    )
    assert record.procedure is not None, "it was carried out"
    procedure = scenario.procedure(record.procedure.procedure)
    lines = procedure_lines(record.procedure, procedure, head_to_world)
    draw_procedure(output / "procedure.png", head, procedure, lines)


def trial_summary(trial: Mapping[str, Any], title: str) -> str:
    """Return a summary of one trial for people; `trial` is a line of results.jsonl."""
    record, target, rigid = trial["record"], trial["targetName"], trial["fits"]["rigid"]
    true_mm, (low, high) = trial["truth"]["trueTreMm"], rigid["treIntervalMm"]
    where = "below" if true_mm < low else "above" if true_mm > high else "in"
    undone, refused = record["undoneTouches"], record["rejectedTouches"]
    score, ctps = trial["score"], trial["ctps"]
    time_score, accuracy_score = score["timeDesirability"], score["accuracyDesirability"]
    parts = f"time {time_score:.2f}, accuracy {accuracy_score:.2f}"
    residuals_mm = rigid["residualsMm"]
    bars = ["▇" * max(1, round(20 * each / max(residuals_mm))) for each in residuals_mm]
    labels = [point["label"] for point in record["points"]]
    rows = zip(labels, residuals_mm, bars, strict=True)
    lines = [
        f"{title}, {record['trainee']}, {record['mode']}",
        _line("Completion time (CT)", record["completionTimeS"], "s"),
        f"  Touches: {undone} undone, {refused} refused",
        *(_line(f"FRE, {kind}", fit["freMm"], "mm") for kind, fit in trial["fits"].items()),
        _line(
            f"Expected TRE, {target}",
            rigid["expectedTreMm"],
            f"mm, 95 % interval from {low:.2f} to {high:.2f}",
        ),
        f"    {INTERVAL_NOTE}",
        _line(f"True TRE, {target}", true_mm, f"mm, {where} that interval"),
        _line("Score", score["score"], f"of 100: {parts}"),
        _line("CTPS as in the paper's tables", ctps["published"], "against the paper's cohort"),
        _line("CTPS by the paper's equation 3", ctps["equation3"], "half of it"),
        f"    {CTPS_WARNING}",
        "  Residual of each fiducial, rigid (mm)",
        *(f"    {label:>3}  {residual:5.2f}  {bar}" for label, residual, bar in rows),
        *(f"  Warning: {warning['message']}" for warning in rigid["warnings"]),
    ]
    return "\n".join(lines)


def procedure_summary(record: TrialRecord, scenario: Scenario, head_to_world: np.ndarray) -> str:
    """Return a summary of the errors of a trial's procedure against the truth, for people.

    `head_to_world` is the true pose, (4, 4) float, mm.
    """
    outcome = procedure_outcome(record, scenario, head_to_world)
    assert outcome is not None, "the trial has a procedure"
    procedure = scenario.procedure(outcome.analysis.procedure)
    lines = [f"{procedure.title}, errors by registration and by hand or robot in brackets"]
    for each in outcome.analysis.trajectories:
        who = "the robot" if each.self_aligned else "hand"
        lines.append(f"  {each.trajectory}, aligned by {who}")
        errors = each.target_point_error, each.entry_point_error
        for name, error in zip(("Target point error", "Entry point error"), errors, strict=True):
            parts = f"({error.by_registration_mm:.2f} and {error.by_hand_mm:.2f})"
            lines.append(_line(f"  {name}", error.mm, f"mm {parts}"))
        by_registration = each.angular_deviation_by_registration_deg
        parts = f"({by_registration:.2f} and {each.angular_deviation_by_hand_deg:.2f})"
        lines.append(_line("  Angular deviation", each.angular_deviation_deg, f"° {parts}"))
        lines.append(_line("  Plunge depth", each.plunge_mm or 0.0, "mm"))
    lines.append(_line("Score of the procedure", outcome.score.score, "of 100"))
    return "\n".join(lines)


def _line(name: str, value: float, unit_and_remark: str) -> str:
    return f"  {name:<34} {value:8.2f} {unit_and_remark}"
