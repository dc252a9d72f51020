"""Write a scenario's folder, whole or not at all, and drafts of heads that become scenarios.

Slicer writes a draft for the planner of tasks: a folder with `draft.json`, `head.ply` and, if
available, `skull.ply` and `volume.nrrd`.
"""

from __future__ import annotations

import contextlib
import shutil
import uuid
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.json_fields import json_object, read_fields
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.files.writing import make_private_folder, write_json
from rastrainer.head.mesh import HeadMesh, read_head_mesh, write_head_mesh
from rastrainer.head.volume import HeadVolume, read_head_volume, read_volume_file, write_head_volume
from rastrainer.json_checks import identifier_of
from rastrainer.json_records import record_to_json
from rastrainer.procedure.plan import NO_GO_FOLDER, procedure_json
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import FILE_NAME, FORMAT_VERSION, SKULL_KINDS, Camera, Scenario

HEAD_NAME, SKULL_NAME, VOLUME_NAME = "head.ply", "skull.ply", "volume.nrrd"
_DECIMALS = 4


def require_new(folder: Path) -> None:
    """Check that a folder can be made."""
    if folder.is_symlink() or folder.is_file() or (folder.is_dir() and any(folder.iterdir())):
        raise InputError(f"{folder} already exists; name a new or empty folder.")


@contextlib.contextmanager
def new_folder(folder: Path) -> Iterator[Path]:
    """Yield a temporary folder that becomes `folder` at the end, or is deleted on failure."""
    folder = Path(folder).absolute()
    require_new(folder)
    partial = folder.parent / f".{uuid.uuid4().hex}.partial"
    try:
        # The head may have a recognizable face.
        make_private_folder(folder.parent)
        partial.mkdir()
        yield partial
        partial.replace(folder)
    except OSError as error:
        raise InputError(f"The folder {folder} cannot be written: {error.strerror}.") from None
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def scenario_name(title: str) -> str:
    """Return a name for commands and records, derived from a title."""
    name = identifier_of(title)
    if not name:
        raise InputError(
            f"{title!r} cannot be a scenario's title: it needs a Latin letter or digit."
        )
    return name


def write_scenario(
    folder: Path,
    scenario: Scenario,
    head: HeadMesh,
    skull: HeadMesh | None = None,
    volume: HeadVolume | None = None,
    no_go: Mapping[str, HeadMesh] | None = None,
) -> None:
    """Write `scenario.json`, meshes, volume and tasks into an existing folder.

    Procedures are written only with a skull.

    Args:
        folder: such as from `new_folder`.
        scenario: the scenario; its own paths are ignored.
        head: the head's mesh.
        skull: the skull's mesh, or None.
        volume: the images, or None.
        no_go: the meshes of the procedures' no-go structures, by file name.
    """
    (folder / "tasks").mkdir(exist_ok=True)
    write_head_mesh(folder / HEAD_NAME, head)
    if skull is not None:
        write_head_mesh(folder / SKULL_NAME, skull)
    if volume is not None:
        write_head_volume(folder / VOLUME_NAME, volume)
    for task in scenario.tasks:
        write_markups(folder / _file(task), PointList(task.labels, task.fiducials))
    for name, mesh in (no_go or {}).items():
        (folder / NO_GO_FOLDER).mkdir(exist_ok=True)
        write_head_mesh(folder / NO_GO_FOLDER / name, mesh)
    content = scenario_json(scenario, skull is not None, volume)
    write_json(folder / FILE_NAME, content)


def scenario_json(
    scenario: Scenario, has_skull: bool, volume: HeadVolume | None = None
) -> dict[str, Any]:
    """Return the content of a scenario's `scenario.json`."""
    furniture = scenario.furniture
    content: dict[str, Any] = {
        "formatVersion": FORMAT_VERSION,
        "name": scenario.name,
        "title": scenario.title,
        "head": HEAD_NAME,
        "target": _named_point(scenario.target_name, scenario.target_position),
        "headToWorld": _listed(scenario.head_to_world.ravel(), 9),
        "perturbation": json_object(scenario.perturbation),
        "tasks": [_task_entry(task) for task in scenario.tasks],
        "cameras": {name: _camera(camera) for name, camera in scenario.cameras.items()},
        "table": {
            "centerMm": _listed(furniture.table_center),
            "sizeMm": _listed(furniture.table_size),
        },
        "stand": {"diameterMm": furniture.stand_diameter},
        "provenance": json_object(scenario.provenance),
    }
    if has_skull:
        kind = SKULL_KINDS[1 if scenario.is_skull_approximate else 0]
        content["skull"] = {"file": SKULL_NAME, "kind": kind}
    if volume is not None:
        content["volume"] = volume_entry(volume)
    if scenario.targets:
        content["targets"] = [_named_point(t.name, t.position) for t in scenario.targets]
    if scenario.trajectory is not None:
        content["trajectory"] = {
            "name": scenario.trajectory.name,
            "entryRas": _listed(scenario.trajectory.entry),
            "targetRas": _listed(scenario.trajectory.target),
        }
    if scenario.landmarks:
        content["landmarks"] = [
            _named_point(each.name, each.position) for each in scenario.landmarks
        ]
    if not scenario.skin.is_none:
        content["skin"] = record_to_json(scenario.skin)
    if scenario.procedures and has_skull:
        content["procedures"] = [procedure_json(each) for each in scenario.procedures]
    return content


def volume_entry(volume: HeadVolume) -> dict[str, Any]:
    return {"file": VOLUME_NAME, "window": volume.window, "level": volume.level}


def _task_entry(task: Task) -> dict[str, Any]:
    entry: dict[str, Any] = {"name": task.name, "title": task.title, "file": _file(task)}
    entry["complexity"] = round(task.complexity, 2)
    if task.shortest_path_mm is not None:
        entry["shortestPathMm"] = round(task.shortest_path_mm, 1)
    return entry


def _file(task: Task) -> str:
    return f"tasks/{task.name}.mrk.json"


def _named_point(name: str, position: np.ndarray) -> dict[str, Any]:
    return {"name": name, "positionRas": _listed(position)}


def _camera(camera: Camera) -> dict[str, Any]:
    return {
        "positionMm": _listed(camera.position),
        "focalPointMm": _listed(camera.focal_point),
        "viewUp": _listed(camera.view_up, 9),
        "viewAngleDeg": camera.view_angle_deg,
    }


def _listed(values: np.ndarray, decimals: int = _DECIMALS) -> list[float]:
    return [round(float(value), decimals) + 0.0 for value in values]


DRAFT_NAME = "draft.json"
NO_SKULL = "none"


@dataclass(frozen=True)
class HeadDraft:
    """A head and how it was made.

    Attributes:
        head: closed, with a flat base, RAS mm.
        method: how it was made, for the provenance.
        skull: or None.
        is_skull_approximate: whether the skull is only the skin moved inward.
        volume: the images, or None.
    """

    head: HeadMesh
    method: str
    skull: HeadMesh | None = None
    is_skull_approximate: bool = False
    volume: HeadVolume | None = None


def write_draft(folder: Path, draft: HeadDraft) -> None:
    """Write a draft into an existing folder."""
    kind = SKULL_KINDS[int(draft.is_skull_approximate)] if draft.skull else NO_SKULL
    write_head_mesh(folder / HEAD_NAME, draft.head)
    if draft.skull is not None:
        write_head_mesh(folder / SKULL_NAME, draft.skull)
    content: dict[str, Any] = {"method": draft.method, "skull": kind}
    if draft.volume is not None:
        write_head_volume(folder / VOLUME_NAME, draft.volume)
        content["volume"] = volume_entry(draft.volume)
    write_json(folder / DRAFT_NAME, content)


def read_draft(folder: Path) -> HeadDraft:
    """Read a draft."""
    fields = read_fields(folder / DRAFT_NAME)
    kind = fields.one_of("skull", (*SKULL_KINDS, NO_SKULL))
    volume = read_volume_file(fields)
    return HeadDraft(
        read_head_mesh(folder / HEAD_NAME),
        fields.text("method", 4000),
        None if kind == NO_SKULL else read_head_mesh(folder / SKULL_NAME),
        kind == SKULL_KINDS[1],
        None if volume is None else read_head_volume(volume),
    )
