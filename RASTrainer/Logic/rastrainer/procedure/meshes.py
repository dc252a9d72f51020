"""The meshes that a procedure needs: the skull and the no-go structures."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.procedure.plan import Procedure

MAX_NO_GO_TRIANGLES = 200_000


@dataclass(frozen=True, eq=False)
class ProcedureMeshes:
    """What lies in the way of a procedure's instruments; RAS mm.

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

    Raises:
        InputError: a mesh is missing, unusable, open or too large.
    """
    mesh = read_head_mesh(skull)
    if not mesh.is_closed:
        raise InputError(f"The skull {skull} is not closed: it has a hole.")
    no_go = {structure.name: read_no_go_mesh(structure.mesh) for structure in procedure.no_go}
    return ProcedureMeshes(mesh, no_go)


def read_no_go_mesh(path: Path) -> HeadMesh:
    """Read the surface of a no-go structure.

    Raises:
        InputError: it is missing, unusable, open or too large.
    """
    mesh = read_head_mesh(path)
    check_no_go_mesh(mesh, str(path))
    return mesh


def check_no_go_mesh(mesh: HeadMesh, name: str) -> None:
    """Check that instruments can be kept away from a surface.

    Args:
        mesh: to check.
        name: by which an error names it.

    Raises:
        InputError: it is open or too large.
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
    """Return the surfaces of all no-go structures of some procedures, by file name.

    Raises:
        InputError: one is missing, unusable, open or too large.
    """
    paths = {structure.mesh for procedure in procedures for structure in procedure.no_go}
    return {path.name: read_no_go_mesh(path) for path in sorted(paths)}
