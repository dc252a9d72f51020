"""A trial as files for 3D Slicer: points and lines, the transform, residuals as a table."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.files.point_list import PointList, write_line, write_markups, write_point_cloud
from rastrainer.files.writing import make_folder, write_text
from rastrainer.registration.fits import RIGID
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.tidy_csv import csv_text

_TO_LPS = np.diag([-1.0, -1.0, 1.0, 1.0])


def write_slicer_files(trial: StoredTrial, folder: Path) -> list[Path]:
    """Write a trial's files and return their paths.

    `touched-world.mrk.json` has the touches in the robot's frame, `touched-ras.mrk.json` the same
    after rigid registration, `WorldToRas.tfm` the registration, `residuals.csv` its residuals;
    `traced-world.mrk.json` and `traced-ras.mrk.json` have the points of a trace, the files `.ply`
    beside them the same as point clouds. Each
    trajectory of a procedure, counted from 1, has the line `trajectory-1-planned.mrk.json` and,
    where the truth is known, `trajectory-1-shown.mrk.json`, where the plan as it was shown truly
    lay in the head, and `trajectory-1-placed.mrk.json` from the guide's tip to the instrument's,
    all in RAS.

    Raises:
        InputError: the folder cannot be written.
    """
    make_folder(folder)
    record, rigid = trial.record, trial.registrations.get(RIGID)
    world = folder / "touched-world.mrk.json"
    write_markups(world, PointList(record.labels, record.positions_mm))
    if rigid is None:
        return [world, *_write_trace(trial, folder, None), *_write_lines(trial, folder)]
    matrix = np.reshape(rigid.matrix, (4, 4))
    ras, transform, table = (
        folder / name for name in ("touched-ras.mrk.json", "WorldToRas.tfm", "residuals.csv")
    )
    moved = transforms.apply(matrix, record.positions_mm)
    write_markups(ras, PointList(record.labels, moved))
    write_text(transform, transform_text(matrix))
    rows = [
        [label, repr(value)] for label, value in zip(rigid.labels, rigid.residuals_mm, strict=True)
    ]
    write_text(table, csv_text(["fiducial", "residual_mm"], rows))
    traced = _write_trace(trial, folder, matrix)
    return [world, ras, transform, table, *traced, *_write_lines(trial, folder)]


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
        write_point_cloud(cloud, places, "World" if frame == "world" else "RAS")
        written += [path, cloud]
    return written


def _write_lines(trial: StoredTrial, folder: Path) -> list[Path]:
    """Write the lines of the trial's procedure, if it has one."""
    procedure, written = trial.record.procedure, []
    for number, one in enumerate(procedure.instruments if procedure else (), start=1):
        planned = np.array([one.entry_ras, one.target_ras])
        lines = {"planned": planned}
        if trial.head_to_world is not None and procedure is not None:
            to_ras = transforms.inverse(np.reshape(trial.head_to_world, (4, 4)))
            to_world = transforms.inverse(procedure.accepted.world_to_head)
            placed = [one.guide_tip_mm, one.at_depth(one.instrument_depth_mm)]
            lines["shown"] = transforms.apply(to_ras @ to_world, planned)
            lines["placed"] = transforms.apply(to_ras, np.array(placed))
        for kind, ends in lines.items():
            path = folder / f"trajectory-{number}-{kind}.mrk.json"
            labels = ("guide", "tip") if kind == "placed" else ("entry", "target")
            write_line(path, f"{one.trajectory} ({kind})", PointList(labels, ends))
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
