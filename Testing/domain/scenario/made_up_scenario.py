"""A scenario on a spherical head, for tests of files and packages."""

import json
import struct
import zlib
from pathlib import Path

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.head.volume import HeadVolume
from rastrainer.scenario.points import PlannedTarget, PlannedTrajectory, Task, task_file
from rastrainer.scenario.scenario import Provenance, Scenario
from rastrainer.scenario.setup import SetUp
from Testing.domain.head.spheres import RADIUS_MM, sphere_mesh


def png(width=4, height=3):
    """Return a PNG file of one color."""

    def chunk(name, content):
        check = struct.pack(">I", zlib.crc32(name + content))
        return struct.pack(">I", len(content)) + name + content + check

    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    rows = zlib.compress((b"\0" + bytes((40, 90, 160)) * width) * height)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")
    )


def ball_head(radius=90.0):
    sphere = sphere_mesh(3)
    return HeadMesh(sphere.vertices * radius / RADIUS_MM, sphere.triangles)


def ball_volume(radius=90.0, spacing=4.0):
    """The images of a spherical head: 100 inside, 0 outside."""
    count = int(2 * (radius + 20.0) / spacing)
    matrix = np.diag([spacing, spacing, spacing, 1.0])
    matrix[:3, 3] = -spacing * (count - 1) / 2.0
    places = np.moveaxis(np.indices((count,) * 3), 0, -1) * spacing + matrix[:3, 3]
    values = np.where(np.linalg.norm(places, axis=-1) < radius, 100, 0).astype(np.uint8)
    return HeadVolume(values, matrix, 100.0, 50.0)


def made_up_scenario():
    setup = SetUp()
    points = np.random.default_rng(4).uniform(-90, 90, (2, 15, 3)).round(4)
    tasks = tuple(
        Task(name, name.title(), task_file(name), 10.0 + row, shortest, fiducials=points[row])
        for row, (name, shortest) in enumerate({"task-1": 500.0, "task-2": None}.items())
    )
    return Scenario(
        format_version=1,
        name="ball",
        title="A ball",
        head=Path("head.ply"),
        target=PlannedTarget("Tumor", np.array([1.0, -17.0, 2.5])),
        head_to_world=setup.head_to_world(np.zeros(3)),
        perturbation=setup.perturbation,
        tasks=tasks,
        cameras=setup.cameras(),
        table=setup.table_in_world(),
        stand=setup.stand,
        provenance=Provenance("made up", "by hand", "none needed"),
        targets=(PlannedTarget("Cyst", np.array([10.0, 20.0, 30.0])),),
        trajectory=PlannedTrajectory("Biopsy", np.array([0.0, 0.0, 90.0]), np.zeros(3)),
    )


def change_scenario(folder, path, value):
    """Replace one value of a scenario, given by a path such as cameras.far.viewUp."""
    file = folder / "scenario.json"
    content = json.loads(file.read_text())
    *parents, last = path.split(".")
    place = content
    for parent in parents:
        place = place[int(parent) if parent.isdigit() else parent]
    place[last] = value
    file.write_text(json.dumps(content))
