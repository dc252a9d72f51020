"""A procedure planned in a scenario: trajectories, no-go structures and their meshes, checkpoints.

A biopsy has one trajectory, deep brain stimulation (DBS) mostly two, and stereo-EEG (SEEG) several.
The instrument goes straight from the entry to the target.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields, read_fields
from rastrainer.head.mesh import RAS_LIMIT_MM, HeadMesh, read_head_mesh
from rastrainer.json_checks import IDENTIFIER_WORDS, is_identifier

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


@dataclass(frozen=True)
class ProcedureTrajectory:
    """The planned straight path of one instrument.

    Attributes:
        name: for people and records; unique in its procedure.
        entry: (3,) float, RAS mm, near the skin.
        target: (3,) float, RAS mm, where the instrument's tip is to be.
        diameter_mm: of the instrument.
        safety_mm: least planned distance of the instrument's surface to a no-go structure.
    """

    name: str
    entry: np.ndarray
    target: np.ndarray
    diameter_mm: float
    safety_mm: float

    @property
    def length_mm(self) -> float:
        return float(np.linalg.norm(self.target - self.entry))

    @property
    def direction(self) -> np.ndarray:
        """(3,) float, unit vector from entry to target, RAS."""
        return (self.target - self.entry) / self.length_mm


@dataclass(frozen=True)
class NoGoStructure:
    """A structure that no instrument may touch, such as a vessel.

    Attributes:
        name: for people; unique in its procedure.
        mesh: path of its closed surface, a mesh like the head's, RAS mm.
    """

    name: str
    mesh: Path


@dataclass(frozen=True)
class Checkpoint:
    """A landmark of the skin at which a registration can be verified.

    Attributes:
        name: for people and records; unique in its procedure.
        position: (3,) float, RAS mm.
    """

    name: str
    position: np.ndarray


_Named = TypeVar("_Named", ProcedureTrajectory, NoGoStructure, Checkpoint)


@dataclass(frozen=True)
class Procedure:
    """A planned procedure.

    Attributes:
        name: for commands and records: lower-case letters, digits and hyphens.
        title: for people.
        kind: what is done.
        source: of the plan: where the coordinates come from.
        trajectories: in the order to do; at least one.
        no_go: structures to keep away from.
        checkpoints: landmarks for verifying the registration.
    """

    name: str
    title: str
    kind: ProcedureKind
    source: str
    trajectories: tuple[ProcedureTrajectory, ...]
    no_go: tuple[NoGoStructure, ...] = ()
    checkpoints: tuple[Checkpoint, ...] = ()

    def trajectory(self, name: str) -> ProcedureTrajectory:
        """Return the trajectory of this name."""
        for trajectory in self.trajectories:
            if trajectory.name == name:
                return trajectory
        names = ", ".join(trajectory.name for trajectory in self.trajectories)
        raise InputError(f"The procedure {self.name} has no trajectory {name!r}; it has {names}.")

    def sha256(self, skull: Path) -> str:
        """Return a hash of what a trial with this procedure depends on, for a journal's header.

        It covers trajectories, checkpoints, no-go structures and the skull, but neither title nor
        source.

        Args:
            skull: path of the skull's mesh.

        Raises:
            OSError: a mesh cannot be read.
        """
        content = procedure_json(self)
        del content["title"], content["source"]
        whole = hashlib.sha256(json.dumps(content, sort_keys=True).encode())
        for path in (skull, *(structure.mesh for structure in self.no_go)):
            whole.update(hashlib.sha256(path.read_bytes()).digest())
        return whole.hexdigest()


def read_procedures(fields: Fields) -> tuple[Procedure, ...]:
    """Return the optional field `procedures` of a scenario. Meshes are only named, not read."""
    if "procedures" not in fields.names():
        return ()
    entries = fields.list_of_fields("procedures", 0, MAX_PROCEDURES)
    procedures = tuple(_read_procedure(entry) for entry in entries)
    _check_names(fields, "procedures", [procedure.name for procedure in procedures])
    if procedures and "skull" not in fields.names():
        raise fields.error(
            "skull", "given, because the scenario has procedures, and drilling needs a skull"
        )
    files = {structure.mesh for procedure in procedures for structure in procedure.no_go}
    if len(files) > MAX_NO_GO_FILES:
        raise fields.error("procedures", f"with at most {MAX_NO_GO_FILES} files of no-go meshes")
    return procedures


def read_procedure(path: Path) -> Procedure:
    """Return the procedure as a separate file, written as in a scenario's list.

    Meshes are only named, not read; they are in the folder `no-go` beside the file.
    """
    return _read_procedure(read_fields(path))


def procedure_json(procedure: Procedure) -> dict[str, Any]:
    """Return the JSON entry of a procedure, with its no-go meshes as in `no_go_file`."""
    return {
        "name": procedure.name,
        "title": procedure.title,
        "kind": procedure.kind.value,
        "source": procedure.source,
        "trajectories": [
            {
                "name": trajectory.name,
                "entryRas": _listed(trajectory.entry),
                "targetRas": _listed(trajectory.target),
                "diameterMm": trajectory.diameter_mm,
                "safetyMm": trajectory.safety_mm,
            }
            for trajectory in procedure.trajectories
        ],
        "noGo": [
            {"name": structure.name, "file": no_go_file(structure)} for structure in procedure.no_go
        ],
        "checkpoints": [
            {"name": checkpoint.name, "positionRas": _listed(checkpoint.position)}
            for checkpoint in procedure.checkpoints
        ],
    }


def no_go_file(structure: NoGoStructure) -> str:
    """Return the path of a structure's mesh in a scenario's folder."""
    return f"{NO_GO_FOLDER}/{structure.mesh.name}"


def _read_procedure(fields: Fields) -> Procedure:
    return Procedure(
        name=fields.identifier("name"),
        title=fields.text("title", 80),
        kind=ProcedureKind(fields.one_of("kind", tuple(kind.value for kind in ProcedureKind))),
        source=fields.text("source", 4000),
        trajectories=_all(fields, "trajectories", (1, MAX_TRAJECTORIES), _read_trajectory),
        no_go=_all(fields, "noGo", (0, MAX_NO_GO), _read_no_go),
        checkpoints=_all(fields, "checkpoints", (0, MAX_CHECKPOINTS), _read_checkpoint),
    )


def _read_trajectory(fields: Fields) -> ProcedureTrajectory:
    trajectory = ProcedureTrajectory(
        name=fields.text("name", 60),
        entry=fields.point("entryRas", RAS_LIMIT_MM),
        target=fields.point("targetRas", RAS_LIMIT_MM),
        diameter_mm=fields.number("diameterMm", *DIAMETERS_MM),
        safety_mm=fields.number("safetyMm", 0.0, MAX_SAFETY_MM),
    )
    if trajectory.length_mm < MIN_LENGTH_MM:
        raise fields.error("entryRas", f"at least {MIN_LENGTH_MM:g} mm from targetRas")
    return trajectory


def _read_no_go(fields: Fields) -> NoGoStructure:
    path = fields.file("file")
    if path.parent.name != NO_GO_FOLDER or path.suffix != ".ply" or not is_identifier(path.stem):
        raise fields.error("file", f"{NO_GO_FOLDER}/NAME.ply with a NAME of {IDENTIFIER_WORDS}")
    return NoGoStructure(fields.text("name", 60), path)


def _read_checkpoint(fields: Fields) -> Checkpoint:
    return Checkpoint(fields.text("name", 60), fields.point("positionRas", RAS_LIMIT_MM))


def _all(
    fields: Fields, name: str, counts: tuple[int, int], read: Callable[[Fields], _Named]
) -> tuple[_Named, ...]:
    """Return the parts of a procedure in one list, whose names must differ."""
    if counts[0] == 0 and name not in fields.names():
        return ()
    parts = tuple(read(entry) for entry in fields.list_of_fields(name, *counts))
    _check_names(fields, name, [part.name for part in parts])
    return parts


def _check_names(fields: Fields, name: str, names: list[str]) -> None:
    if len(set(names)) != len(names):
        raise fields.error(name, "a list in which each name occurs once")


def _listed(point: np.ndarray) -> list[float]:
    return [round(float(value), 4) + 0.0 for value in point]


MAX_NO_GO_TRIANGLES = 200_000


@dataclass(frozen=True, eq=False)
class ProcedureMeshes:
    """The obstacles of a procedure's instruments; RAS mm.

    Attributes:
        skull: bone between its outer and its inner table; closed.
        no_go: the closed surfaces of the no-go structures by name, in the procedure's order.
    """

    skull: HeadMesh
    no_go: Mapping[str, HeadMesh]


def read_procedure_meshes(procedure: Procedure, skull: Path) -> ProcedureMeshes:
    """Read the meshes of a procedure.

    Args:
        procedure: names the meshes of its no-go structures.
        skull: path of the scenario's skull.
    """
    mesh = read_head_mesh(skull)
    if not mesh.is_closed:
        raise InputError(f"The skull {skull} is not closed: it has a hole.")
    no_go = {structure.name: read_no_go_mesh(structure.mesh) for structure in procedure.no_go}
    return ProcedureMeshes(mesh, no_go)


def read_no_go_mesh(path: Path) -> HeadMesh:
    """Read the surface of a no-go structure."""
    mesh = read_head_mesh(path)
    check_no_go_mesh(mesh, str(path))
    return mesh


def check_no_go_mesh(mesh: HeadMesh, name: str) -> None:
    """Check that instruments can be kept away from a surface.

    Args:
        mesh: to check.
        name: by which an error names it.
    """
    check_no_go_size(len(mesh.triangles), name)
    if not mesh.is_closed:
        raise InputError(f"The no-go structure {name} is not closed: it has a hole.")


def check_no_go_size(triangles: int, name: str) -> None:
    """Raise `InputError` if a no-go structure has more triangles than one may have."""
    if triangles > MAX_NO_GO_TRIANGLES:
        raise InputError(
            f"The no-go structure {name} has {triangles} triangles; it may have "
            f"{MAX_NO_GO_TRIANGLES}."
        )


def read_all_no_go(procedures: Iterable[Procedure]) -> dict[str, HeadMesh]:
    """Return the surfaces of all no-go structures of some procedures, by file name."""
    paths = {structure.mesh for procedure in procedures for structure in procedure.no_go}
    return {path.name: read_no_go_mesh(path) for path in sorted(paths)}
