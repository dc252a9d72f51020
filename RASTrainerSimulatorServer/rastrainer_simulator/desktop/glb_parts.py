"""Read a scene's GLB into parts: surfaces that move with one body, or stand still."""

from __future__ import annotations

import io
from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
import trimesh

from rastrainer.errors import InputError

UNREADABLE = "The scene that the simulator sent cannot be read: {reason}."


@dataclass(frozen=True)
class Finish:
    """How a surface looks: linear colors 0 to 1 as in glTF, roughness, metallicity, opacity."""

    color: tuple[float, float, float]
    glow: tuple[float, float, float]
    roughness: float
    metallic: float
    opacity: float = 1.0

    @property
    def is_glowing(self) -> bool:
        """Whether it has its own color in any light."""
        return any(self.glow)


@dataclass(frozen=True)
class Part:
    """Triangles of one finish.

    Attributes:
        nodes: names of its node and of those above, the nearest first.
        body: that it moves with; "" for what stands still.
        vertices: (n, 3) float, m, in the body's frame, else in World.
        normals: (n, 3) float, the same.
        triangles: (m, 3) int.
        finish: of all of it.
    """

    nodes: tuple[str, ...]
    body: str
    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    finish: Finish


def read_parts(content: bytes, bodies: Collection[str]) -> list[Part]:
    """Return the parts of a GLB in which the nodes named `bodies` can be moved.

    Raises:
        InputError: it is no GLB, or none of the bodies is in it.
    """
    try:
        scene = trimesh.load_scene(io.BytesIO(content), file_type="glb", process=False)
        parents = dict(scene.graph.transforms.parents)
    except Exception as error:  # Whatever trimesh trips over in a file that is not what it says.
        raise InputError(UNREADABLE.format(reason=error)) from None
    present = [name for name in bodies if name in parents]
    if not present:
        raise InputError(UNREADABLE.format(reason="the robot is not in it"))
    world = parents[present[0]]
    parts = []
    for name in scene.graph.nodes_geometry:
        ancestry = _ancestry(name, parents)
        body = next((node for node in ancestry if node in bodies), "")
        matrix, geometry = scene.graph.get(name, body or world)
        parts.append(_part(scene.geometry[geometry], matrix, ancestry, body))
    return parts


def _ancestry(name: str, parents: dict[str, str]) -> tuple[str, ...]:
    found = [name]
    while found[-1] in parents:
        found.append(parents[found[-1]])
    return tuple(found)


def _part(mesh: trimesh.Trimesh, matrix: np.ndarray, nodes: tuple[str, ...], body: str) -> Part:
    vertices = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    normals = mesh.vertex_normals @ matrix[:3, :3].T
    return Part(nodes, body, vertices, normals, np.asarray(mesh.faces), _finish(mesh))


def _finish(mesh: trimesh.Trimesh) -> Finish:
    material = getattr(mesh.visual, "material", None)
    color = getattr(material, "baseColorFactor", None)
    glow = getattr(material, "emissiveFactor", None)
    roughness = getattr(material, "roughnessFactor", None)
    metallic = getattr(material, "metallicFactor", None)
    return Finish(
        (0.6, 0.6, 0.6) if color is None else tuple((np.asarray(color)[:3] / 255.0).tolist()),
        (0.0, 0.0, 0.0) if glow is None else tuple(np.asarray(glow, dtype=float).tolist()),
        0.5 if roughness is None else float(roughness),
        0.0 if metallic is None else float(metallic),
        1.0 if color is None else float(color[3]) / 255.0,
    )
