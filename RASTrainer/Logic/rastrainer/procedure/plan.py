"""A procedure planned in a scenario: trajectories, no-go structures and their meshes, checkpoints.

A biopsy has one trajectory, deep brain stimulation (DBS) mostly two, and stereo-EEG (SEEG) several.
The instrument goes straight from the entry to the target.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import path_beside, read_record, relative_path
from rastrainer.files.writing import rounded
from rastrainer.head.mesh import RAS_LIMIT_MM, HeadMesh, read_head_mesh
from rastrainer.json_checks import (
    IDENTIFIER_WORDS,
    SizeCheck,
    identifier,
    is_identifier,
    list_of,
    number,
    point,
    text,
)
from rastrainer.json_records import record_to_json

MAX_PROCEDURES = 10
MAX_TRAJECTORIES = 20
MAX_NO_GO = 10
MAX_CHECKPOINTS = 20
MAX_NO_GO_FILES = 30
"""Size limit of all procedures of a scenario together, so that a package can hold them."""
MIN_LENGTH_MM = 10.0
DIAMETERS_MM = (0.5, 10.0)
MAX_SAFETY_MM = 20.0
NO_GO_FOLDER = "no-go"


class ProcedureKind(str, Enum):
    """The kind of a procedure."""

    BIOPSY = "biopsy"
    DBS = "dbs"
    SEEG = "seeg"


def named_once(minimum: int, maximum: int) -> SizeCheck:
    """Accept a list of objects with different names."""
    check_size = list_of(minimum, maximum, "objects")

    def check(value: Any) -> Any:
        items = check_size(value)
        names = [str(item.get("name")) for item in items if isinstance(item, Mapping)]
        if len(set(names)) != len(names):
            raise ValueError("a list in which each name occurs once")
        return items

    return SizeCheck(check)


def _no_go_path(value: Any) -> Path:
    path = relative_path(value)
    if path.parent.name != NO_GO_FOLDER or path.suffix != ".ply" or not is_identifier(path.stem):
        raise ValueError(f"{NO_GO_FOLDER}/NAME.ply with a NAME of {IDENTIFIER_WORDS}")
    return path


_Name = Annotated[str, text(60)]
_Point = Annotated[np.ndarray, point(RAS_LIMIT_MM)]


@dataclass(frozen=True)
class ProcedureTrajectory:
    """The planned straight path of one instrument from near the skin to its tip's target.

    `safety_mm` is the least planned distance of its surface to a no-go structure.
    """

    name: _Name
    entry_ras: _Point
    target_ras: _Point
    diameter_mm: Annotated[float, number(*DIAMETERS_MM, "mm")]
    safety_mm: Annotated[float, number(0, MAX_SAFETY_MM, "mm")]

    @property
    def length_mm(self) -> float:
        return float(np.linalg.norm(self.target_ras - self.entry_ras))

    @property
    def direction(self) -> np.ndarray:
        """(3,) float, unit vector from entry to target, RAS."""
        return (self.target_ras - self.entry_ras) / self.length_mm


@dataclass(frozen=True)
class NoGoStructure:
    """A structure that no instrument may touch, such as a vessel: a closed mesh, RAS mm."""

    name: _Name
    file: Annotated[Path, _no_go_path]


@dataclass(frozen=True)
class Checkpoint:
    """A landmark of the skin at which a registration can be verified; (3,) float, mm."""

    name: _Name
    position_ras: _Point


@dataclass(frozen=True)
class Procedure:
    """A planned procedure; its source is where the coordinates come from."""

    name: Annotated[str, identifier]
    title: Annotated[str, text(80)]
    kind: ProcedureKind
    source: Annotated[str, text(4000)]
    trajectories: Annotated[tuple[ProcedureTrajectory, ...], named_once(1, MAX_TRAJECTORIES)]
    no_go: Annotated[tuple[NoGoStructure, ...], named_once(0, MAX_NO_GO)] = ()
    checkpoints: Annotated[tuple[Checkpoint, ...], named_once(0, MAX_CHECKPOINTS)] = ()

    def sha256(self, skull: Path) -> str:
        """Return a hash of what a trial with this procedure depends on, for a journal's header.

        It covers trajectories, checkpoints, no-go structures and the skull, but neither title nor
        source. `OSError` if a mesh cannot be read.
        """
        content = procedure_json(self)
        del content["title"], content["source"]
        whole = hashlib.sha256(json.dumps(content, sort_keys=True).encode())
        for path in (skull, *(structure.file for structure in self.no_go)):
            whole.update(hashlib.sha256(path.read_bytes()).digest())
        return whole.hexdigest()


def read_procedure(path: Path) -> Procedure:
    """Return the procedure as a separate file, written as in a scenario's list.

    Meshes are only named, not read; they are in the folder `no-go` next to the file.
    """
    return located(read_record(Procedure, path), path, "")


def located(procedure: Procedure, file: Path, key: str) -> Procedure:
    """Return a procedure of a JSON file with the paths of its meshes.

    `key` begins the names of the file's fields in errors.
    """
    for index, each in enumerate(procedure.trajectories):
        if each.length_mm < MIN_LENGTH_MM:
            raise InputError(
                f"{file}: {key}trajectories[{index}].entryRas must be at least {MIN_LENGTH_MM:g} "
                "mm from targetRas."
            )
    no_go = tuple(
        replace(each, file=path_beside(file, each.file, f"{key}noGo[{index}].file"))
        for index, each in enumerate(procedure.no_go)
    )
    return replace(procedure, no_go=no_go)


POINT_DECIMALS = {"entryRas": 4, "targetRas": 4, "positionRas": 4}


def procedure_json(procedure: Procedure) -> dict[str, Any]:
    """Return the JSON entry of a procedure, with its meshes in the folder `no-go` next to it."""
    no_go = [
        {"name": each.name, "file": f"{NO_GO_FOLDER}/{each.file.name}"} for each in procedure.no_go
    ]
    content = {**record_to_json(procedure, with_defaults=True), "noGo": no_go}
    return rounded(content, POINT_DECIMALS)


MAX_NO_GO_TRIANGLES = 200_000


@dataclass(frozen=True, eq=False)
class ProcedureMeshes:
    """The obstacles of a procedure's instruments, closed surfaces in RAS mm.

    The no-go structures are by name, in the procedure's order.
    """

    skull: HeadMesh
    no_go: Mapping[str, HeadMesh]


def read_procedure_meshes(procedure: Procedure, skull: Path) -> ProcedureMeshes:
    mesh = read_head_mesh(skull)
    if not mesh.is_closed:
        raise InputError(f"The skull {skull} is not closed: it has a hole.")
    no_go = {structure.name: read_no_go_mesh(structure.file) for structure in procedure.no_go}
    return ProcedureMeshes(mesh, no_go)


def read_no_go_mesh(path: Path) -> HeadMesh:
    mesh = read_head_mesh(path)
    check_no_go_mesh(mesh, str(path))
    return mesh


def check_no_go_mesh(mesh: HeadMesh, name: str) -> None:
    """Check that instruments can be kept away from a surface."""
    check_no_go_size(len(mesh.triangles), name)
    if not mesh.is_closed:
        raise InputError(f"The no-go structure {name} is not closed: it has a hole.")


def check_no_go_size(triangles: int, name: str) -> None:
    if triangles > MAX_NO_GO_TRIANGLES:
        raise InputError(
            f"The no-go structure {name} has {triangles} triangles; it may have "
            f"{MAX_NO_GO_TRIANGLES}."
        )


def read_all_no_go(procedures: Iterable[Procedure]) -> dict[str, HeadMesh]:
    paths = {structure.file for procedure in procedures for structure in procedure.no_go}
    return {path.name: read_no_go_mesh(path) for path in sorted(paths)}
