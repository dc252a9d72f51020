"""Trials as files for other programs: a Motion-BIDS dataset, and files for 3D Slicer.

In the dataset (BIDS specification 1.10, motion) each trial with a journal becomes `motion/` files
of its trainee: the tip's position and the clearance at 50 Hz in trial time, and the touches as
events. Drills of decisions become `beh/` files. Dates are not exported.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

import rastrainer
from rastrainer import transforms
from rastrainer.decision.drill_record import DrillRecord
from rastrainer.decision.drill_rows import COLUMNS, cells, drill_rows
from rastrainer.errors import InputError
from rastrainer.files.ply import write_ply
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.files.writing import make_empty_folder, make_folder, write_json, write_text
from rastrainer.motion.trajectory import Trajectory, resample
from rastrainer.motion.trial_motion import RATE_HZ
from rastrainer.procedure.errors import true_lines
from rastrainer.protocol import DECIDE
from rastrainer.registration.fits import RIGID
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.study_data import StudyData
from rastrainer.study.tidy_csv import csv_text
from rastrainer.trial.trial_row import TrialRow

BIDS_VERSION = "1.10.0"
TRACKING = "tooltip"
CHANNELS = (
    ("tip_x", "x", "POS", "tool_tip", "mm"),
    ("tip_y", "y", "POS", "tool_tip", "mm"),
    ("tip_z", "z", "POS", "tool_tip", "mm"),
    ("clearance", "n/a", "MISC", "tool_tip", "mm"),
)
KINDS = ("POS", "MISC", "ACCEL", "ANGACCEL", "GYRO", "JNTANG", "LATENCY", "MAGN", "ORNT", "VEL")

FindTrajectory = Callable[[str], Trajectory | None]
"""Returns the trajectory of a trial's UUID."""


def write_motion_bids(data: StudyData, folder: Path, find_trajectory: FindTrajectory) -> int:
    make_empty_folder(folder)
    labels = participant_labels(data.trainees)
    runs: dict[tuple[str, str, str], int] = defaultdict(int)
    written = 0
    for trial in data.trials:
        trajectory = find_trajectory(trial.trial_id) if trial.trial_id else None
        if trajectory is None or len(trajectory.times_s) < 2:
            continue
        runs[trial.trainee, trial.mode, trial.task] += 1
        run = runs[trial.trainee, trial.mode, trial.task]
        _write_trial(folder, labels[trial.trainee], trial, run, trajectory)
        written += 1
    if not written and not data.drills:
        raise InputError("No trial of the study has a journal with a trajectory to export.")
    _write_drills(data.drills, labels, folder)
    present = {trainee for trainee, _, _ in runs} | {drill.trainee for drill in data.drills}
    _write_dataset(folder, data, {name: labels[name] for name in labels if name in present})
    return written


def participant_labels(trainees: tuple[str, ...]) -> dict[str, str]:
    labels: dict[str, str] = {}
    for index, trainee in enumerate(trainees, start=1):
        label = re.sub(r"[^A-Za-z0-9]", "", trainee) or f"P{index:03d}"
        while label.lower() in {other.lower() for other in labels.values()}:
            label += f"x{index}"
        labels[trainee] = label
    return labels


def _write_trial(
    folder: Path, label: str, trial: TrialRow, run: int, trajectory: Trajectory
) -> None:
    place = folder / f"sub-{label}" / "motion"
    place.mkdir(parents=True, exist_ok=True)
    task = re.sub(r"[^A-Za-z0-9]", "", trial.task) or "task"
    start, end = f"sub-{label}_task-{task}", f"acq-{trial.mode}_run-{run:02d}"
    whole = f"{start}_tracksys-{TRACKING}_{end}"
    values = resample(
        trajectory.times_s, np.column_stack([trajectory.tip_mm, trajectory.clearance_mm]), RATE_HZ
    )
    lines = ["\t".join(f"{value:.4f}" for value in row) for row in values]
    write_text(place / f"{whole}_motion.tsv", "\n".join(lines) + "\n")
    write_json(place / f"{whole}_motion.json", _motion_json(task, trajectory))
    rows = [("name", "component", "type", "tracked_point", "units"), *CHANNELS]
    write_text(place / f"{whole}_channels.tsv", _tsv(rows))
    found = [
        *((touch.time_s, 0.0, "touch", touch.label) for touch in trajectory.touches),
        *((touch.time_s, 0.0, "refused_touch", touch.label) for touch in trajectory.refused),
        *((c.start_s, c.duration_s, "contact", "n/a") for c in trajectory.contacts),
    ]
    zero = float(trajectory.times_s[0])
    events = [
        (f"{onset - zero:.4f}", f"{duration:.4f}", kind, label)
        for onset, duration, kind, label in sorted(found)
    ]
    events.insert(0, ("onset", "duration", "trial_type", "fiducial"))
    write_text(place / f"{start}_{end}_events.tsv", _tsv(events))
    write_json(place / f"{start}_{end}_events.json", _EVENTS_JSON)


def _motion_json(task: str, trajectory: Trajectory) -> dict[str, Any]:
    counts = Counter(kind for _name, _component, kind, *_others in CHANNELS)
    return {
        "TaskName": task,
        "TaskDescription": "Fifteen numbered fiducials on a virtual head are touched in order with "
        "the tip of a teleoperated robot.",
        "TrackingSystemName": TRACKING,
        "SamplingFrequency": RATE_HZ,
        "SamplingFrequencyEffective": RATE_HZ,
        "RecordingDuration": round(float(trajectory.times_s[-1] - trajectory.times_s[0]), 3),
        "RecordingType": "continuous",
        "TrackedPointsCount": 1,
        "MotionChannelCount": len(CHANNELS),
        **{f"{kind}ChannelCount": counts[kind] for kind in KINDS},
        "Manufacturer": "RASTrainer",
        "ManufacturersModelName": "simulated KUKA LBR iiwa 7",
        "SoftwareVersions": rastrainer.__version__,
        "InstitutionName": "n/a",
    }


_EVENTS_JSON = {
    "trial_type": {
        "Description": "What happened.",
        "Levels": {
            "touch": "A fiducial was touched, and the touch was kept.",
            "refused_touch": "A touch that did not count.",
            "contact": "The tool touched the head.",
        },
    },
    "fiducial": {"Description": "Label of the fiducial that was due, 1 to 15."},
}


def _write_drills(drills: Sequence[DrillRecord], labels: Mapping[str, str], folder: Path) -> None:
    """Write a table for each drill, and the description of their columns at the top."""
    for drill, row in zip(drills, drill_rows(drills), strict=True):
        subject = f"sub-{labels[drill.trainee]}"
        name = f"{subject}_task-{DECIDE}_acq-{drill.mode}_run-{row.number:02d}_beh.tsv"
        make_folder(folder / subject / "beh")
        found = [["n/a" if cell is None else str(cell) for cell in cells(c)] for c in drill.cases]
        write_text(folder / subject / "beh" / name, _tsv([list(COLUMNS), *found]))
    if drills:
        write_json(folder / f"task-{DECIDE}_beh.json", _DRILL_JSON)


def _tsv(rows: Sequence[Sequence[str]]) -> str:
    """Return rows as text; a cell has no white space but spaces, and is never empty."""
    return "".join("\t".join(" ".join(c.split()) or "n/a" for c in row) + "\n" for row in rows)


_DRILL_JSON: dict[str, Any] = {
    "TaskName": DECIDE,
    "TaskDescription": "In each case, a virtual operator has registered a head to its images, with "
    "a fault or without. The trainee checks places on the head, and proceeds, registers again or "
    "stops.",
    **{
        name: {"Description": description} | ({"Units": units} if units else {})
        for name, (description, units) in COLUMNS.items()
    },
}


def _write_dataset(folder: Path, data: StudyData, labels: Mapping[str, str]) -> None:
    description = {
        "Name": data.title,
        "BIDSVersion": BIDS_VERSION,
        "DatasetType": "raw",
        "License": "n/a",
        "Authors": ["The laboratory that ran the study"],
        "GeneratedBy": [{"Name": "RASTrainer", "Version": rastrainer.__version__}],
    }
    write_json(folder / "dataset_description.json", description)
    write_text(
        folder / "README.md",
        f"# {data.title}\n\nMovements of a simulated surgical robot, teleoperated by trainees who "
        "touched fifteen fiducials on a virtual head in each run. `acq-desktop` was seen on a "
        "screen, `acq-hmd` in a headset. Positions are in the robot's frame (x forward, y left, "
        "z up, mm); time is the trial's own, without pauses. Tables in `beh` have the cases of "
        "drills of decisions. Trainees are pseudonymous.\n",
    )
    rows = [("participant_id", "species", "pseudonym")]
    rows += [(f"sub-{label}", "homo sapiens", name) for name, label in labels.items()]
    write_text(folder / "participants.tsv", _tsv(rows))
    write_json(
        folder / "participants.json",
        {"pseudonym": {"Description": "The trainee's name in the study."}},
    )


_TO_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def write_slicer_files(trial: StoredTrial, folder: Path) -> list[Path]:
    """Write a trial's files and return their paths.

    `touched-world.mrk.json` has the touches in the robot's frame, `touched-ras.mrk.json` the same
    after rigid registration, `WorldToRas.tfm` the registration, `residuals.csv` its residuals.
    `traced-world.mrk.json` and `traced-ras.mrk.json` have the points of a trace, the `.ply` files
    the same points as clouds. Each trajectory of a procedure, counted from 1, has the line
    `trajectory-1-planned.mrk.json` and, if the truth is known, `trajectory-1-shown.mrk.json`, the
    true position of the plan as it was shown, and `trajectory-1-placed.mrk.json` from the guide's
    tip to the instrument's tip, all in RAS.
    """
    make_folder(folder)
    record, rigid = trial.record, trial.registrations.get(RIGID)
    world = folder / "touched-world.mrk.json"
    write_markups(world, PointList(record.labels, record.positions_mm))
    written, matrix = [world], None
    if rigid is not None:
        matrix = np.reshape(rigid.matrix, (4, 4))
        names = ("touched-ras.mrk.json", "WorldToRas.tfm", "residuals.csv")
        ras, transform, table = (folder / name for name in names)
        moved = transforms.apply(matrix, record.positions_mm)
        write_markups(ras, PointList(record.labels, moved))
        write_text(transform, transform_text(matrix))
        residuals = zip(rigid.labels, rigid.residuals_mm, strict=True)
        write_text(table, csv_text(["fiducial", "residual_mm"], residuals))
        written += [ras, transform, table]
    return [*written, *_write_trace(trial, folder, matrix), *_write_lines(trial, folder)]


def _write_trace(trial: StoredTrial, folder: Path, matrix: np.ndarray | None) -> list[Path]:
    """Write the points of the trial's trace, if it has one; World→RAS is (4, 4) float, or None."""
    points = trial.record.trace_mm
    if not len(points):
        return []
    frames = {"world": points}
    if matrix is not None:
        frames["ras"] = transforms.apply(matrix, points)
    written = []
    for frame, places in frames.items():
        path = folder / f"traced-{frame}.mrk.json"
        write_markups(path, PointList((), places))
        cloud = folder / f"traced-{frame}.ply"
        write_ply(cloud, places, "World" if frame == "world" else "RAS")
        written += [path, cloud]
    return written


def _write_lines(trial: StoredTrial, folder: Path) -> list[Path]:
    procedure, written = trial.record.procedure, []
    truth = np.eye(4) if trial.truth is None else trial.truth.matrix
    lines = () if procedure is None else true_lines(procedure, truth)
    for number, line in enumerate(lines, start=1):
        kinds = ("planned",) if trial.truth is None else ("planned", "shown", "placed")
        for kind in kinds:
            path = folder / f"trajectory-{number}-{kind}.mrk.json"
            labels = ("guide", "tip") if kind == "placed" else ("entry", "target")
            points = PointList(labels, getattr(line, kind))
            write_markups(path, points, f"{line.trajectory} ({kind})")
            written.append(path)
    return written


def transform_text(to_parent: np.ndarray) -> str:
    """Return a linear transform, (4, 4) float in RAS mm, as an ITK text file for Slicer.

    ITK's files are in LPS and map from the parent.
    """
    matrix = _TO_LPS @ transforms.inverse(to_parent) @ _TO_LPS
    numbers = [*matrix[:3, :3].ravel(), *matrix[:3, 3]]
    return (
        "#Insight Transform File V1.0\n#Transform 0\nTransform: AffineTransform_double_3_3\n"
        f"Parameters: {' '.join(repr(float(number)) for number in numbers)}\n"
        "FixedParameters: 0 0 0\n"
    )
