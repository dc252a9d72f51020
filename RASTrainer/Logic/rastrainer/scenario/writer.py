"""Write a scenario's folder, whole or not at all, and drafts of heads that become scenarios.

Slicer writes a draft for the planner of tasks: a folder with `draft.json`, `head.ply` and, if
available, `skull.ply` and `volume.nrrd`.
"""

from __future__ import annotations

import contextlib
import shutil
import uuid
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

from rastrainer.errors import InputError
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.files.reading import read_record
from rastrainer.files.writing import make_private_folder, rounded, write_json
from rastrainer.head.mesh import HeadMesh, read_head_mesh, write_head_mesh
from rastrainer.head.volume import HeadVolume, VolumeFile, read_head_volume, write_nrrd
from rastrainer.json_checks import identifier_of, text
from rastrainer.json_records import record_to_json
from rastrainer.procedure.plan import NO_GO_FOLDER, POINT_DECIMALS, procedure_json, read_all_no_go
from rastrainer.scenario.points import task_file
from rastrainer.scenario.scenario import (
    FILE_NAME,
    Scenario,
    SkullFile,
    SkullKind,
)

HEAD_NAME, SKULL_NAME = Path("head.ply"), Path("skull.ply")
VOLUME_NAME = Path("volume.nrrd")


def require_new(folder: Path) -> None:
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

    The scenario's own paths are ignored. Procedures are written only with a skull; their no-go
    structures have their meshes by file name.
    """
    (folder / "tasks").mkdir(exist_ok=True)
    volume_file = _write_files(folder, head, skull, volume)
    tasks = tuple(replace(task, file=task_file(task.name)) for task in scenario.tasks)
    for task in tasks:
        write_markups(folder / task.file, PointList(task.labels, task.fiducials))
    for name, mesh in (no_go or {}).items():
        (folder / NO_GO_FOLDER).mkdir(exist_ok=True)
        write_head_mesh(folder / NO_GO_FOLDER / name, mesh)
    kind = scenario.skull.kind if scenario.skull else SkullKind.BONE
    written = replace(
        scenario,
        head=HEAD_NAME,
        tasks=tasks,
        skull=SkullFile(SKULL_NAME, kind) if skull else None,
        volume=volume_file,
        procedures=(),
    )
    content = record_to_json(written)
    if skull:
        content["procedures"] = list(map(procedure_json, scenario.procedures))
    write_json(folder / FILE_NAME, rounded(content, _DECIMALS))


ScenarioFiles = tuple[HeadMesh, HeadMesh | None, HeadVolume | None, dict[str, HeadMesh]]
"""Head, skull, volume, and meshes of no-go structures by file name: what `write_scenario` takes."""


def read_files(scenario: Scenario) -> ScenarioFiles:
    """Read the meshes and the volume of a loaded scenario."""
    return (
        read_head_mesh(scenario.head),
        read_head_mesh(scenario.skull.file) if scenario.skull else None,
        read_head_volume(scenario.volume) if scenario.volume else None,
        read_all_no_go(scenario.procedures),
    )


_DECIMALS = {
    **POINT_DECIMALS,
    "positionMm": 4,
    "focalPointMm": 4,
    "centerMm": 4,
    "sizeMm": 4,
    "viewUp": 9,
    "headToWorld": 9,
    "complexity": 2,
    "shortestPathMm": 1,
}


def _write_files(
    folder: Path, head: HeadMesh, skull: HeadMesh | None, volume: HeadVolume | None
) -> VolumeFile | None:
    write_head_mesh(folder / HEAD_NAME, head)
    if skull is not None:
        write_head_mesh(folder / SKULL_NAME, skull)
    if volume is None:
        return None
    write_nrrd(folder / VOLUME_NAME, volume.values, volume.ijk_to_ras)
    return VolumeFile(VOLUME_NAME, volume.window, volume.level)


DRAFT_NAME = "draft.json"


@dataclass(frozen=True)
class DraftFile:
    """The content of `draft.json`; see `HeadDraft`."""

    method: Annotated[str, text(4000)]
    skull: SkullKind | None = None
    volume: VolumeFile | None = None


@dataclass(frozen=True)
class HeadDraft:
    """A head, closed, with a flat base, RAS mm, and how it was made, for the provenance."""

    head: HeadMesh
    method: str
    skull: HeadMesh | None = None
    skull_kind: SkullKind = SkullKind.BONE
    volume: HeadVolume | None = None


def write_draft(folder: Path, draft: HeadDraft) -> None:
    volume = _write_files(folder, draft.head, draft.skull, draft.volume)
    file = DraftFile(draft.method, draft.skull_kind if draft.skull else None, volume)
    write_json(folder / DRAFT_NAME, record_to_json(file))


def read_draft(folder: Path) -> HeadDraft:
    path = folder / DRAFT_NAME
    file = read_record(DraftFile, path)
    volume = file.volume
    return HeadDraft(
        read_head_mesh(folder / HEAD_NAME),
        file.method,
        read_head_mesh(folder / SKULL_NAME) if file.skull else None,
        file.skull or SkullKind.BONE,
        read_head_volume(volume.located(path)) if volume else None,
    )
