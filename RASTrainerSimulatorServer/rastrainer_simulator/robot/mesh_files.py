"""Which mesh files show a robot's links and represent them in collisions; none is opened here."""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.vectors import vector

if TYPE_CHECKING:
    import yourdfpy

KINDS = ("visual", "collision")
_SUFFIXES = (".glb", ".dae", ".obj", ".ply", ".stl")
Color = tuple[float, float, float, float]
"""RGBA, 0…1."""
_GREY = (0.8, 0.8, 0.8, 1.0)


@dataclass(frozen=True)
class MeshPart:
    """One mesh of a link."""

    link: str
    kind: str  # "visual" or "collision"
    path: Path
    origin: np.ndarray  # (4, 4) float: the mesh's frame to the link's frame, m
    scale: tuple[float, float, float]
    color: Color
    replaced: bool = False  # used instead of the URDF's own mesh


def mesh_parts(
    robot: yourdfpy.Robot, urdf_folder: Path, mesh_folder: Path | None
) -> tuple[MeshPart, ...]:
    """Return the meshes that a URDF names, or those of `mesh_folder` where it has one for a link.

    `mesh_folder` follows the custom of robot descriptions: `visual/link_3.stl` (or .dae, .obj,
    .ply, .glb) replaces what the link whose name ends in `link_3` shows, `collision/link_3.stl`
    what it collides with, and a plain `link_3.stl` both. Without any visual mesh for a link, its
    collision mesh is shown. Raises InputError where `mesh_folder` fits no link, and where a mesh
    lies outside of the folder in which it is looked for.
    """
    colors = {
        material.name: _rgba(material) for material in robot.materials if material.color is not None
    }
    parts: list[MeshPart] = []
    replaced = False
    for link in robot.links:
        for kind in KINDS:
            other = _replacement(link.name, kind, mesh_folder) if mesh_folder else None
            if other:
                replaced = True
                parts.append(MeshPart(link.name, kind, other, np.eye(4), (1.0,) * 3, _GREY, True))
            else:
                parts.extend(_own_parts(link, kind, urdf_folder, colors))
    if mesh_folder and not replaced:
        raise InputError(
            f"{mesh_folder} has no mesh for this robot; there should be files such as "
            "link_0.stl, visual/link_0.stl or collision/link_0.stl."
        )
    return tuple(parts)


def _replacement(link: str, kind: str, folder: Path) -> Path | None:
    names = [link, *(link[i + 1 :] for i, letter in enumerate(link) if letter == "_")]
    for place in (folder / kind, folder, folder / "collision"):
        for name, suffix in itertools.product(names, _SUFFIXES):
            path = mesh_inside(folder, place / f"{name}{suffix}", link)
            if path.is_file():
                return path
    return None


def _own_parts(
    link: yourdfpy.Link, kind: str, folder: Path, colors: dict[str, Color]
) -> list[MeshPart]:
    parts = []
    for shape in link.visuals if kind == "visual" else link.collisions:
        mesh = shape.geometry.mesh if shape.geometry else None
        if mesh is None or not mesh.filename:
            continue
        name = mesh.filename.partition("://")[2].partition("/")[2] or mesh.filename
        scale = np.broadcast_to(1.0 if mesh.scale is None else mesh.scale, 3)
        origin = np.eye(4) if shape.origin is None else shape.origin
        color = _color(getattr(shape, "material", None), colors)
        parts.append(
            MeshPart(
                link.name,
                kind,
                mesh_inside(folder, folder / name, link.name),
                origin,
                vector(scale),
                color,
            )
        )
    return parts


def mesh_inside(folder: Path, path: Path, link: str) -> Path:
    """Return `path`, which a file names for a link.

    Raises:
        InputError: it leads out of `folder`.
    """
    try:
        is_inside = path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # such as a ring of symbolic links
        is_inside = False
    if not is_inside:
        raise InputError(f"The mesh {path} of {link} must be in {folder} or below it.")
    return path


def _color(material: yourdfpy.Material | None, colors: dict[str, Color]) -> Color:
    if material is None:
        return _GREY
    return _rgba(material) if material.color is not None else colors.get(material.name, _GREY)


def _rgba(material: yourdfpy.Material) -> Color:
    red, green, blue, opacity = map(float, material.color.rgba)
    return red, green, blue, opacity
