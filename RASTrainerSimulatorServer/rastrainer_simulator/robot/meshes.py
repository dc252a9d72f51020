"""Open the mesh files of a robot's links: checked, in meters, each in its link's frame."""

from __future__ import annotations

import io
from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import read_bytes
from rastrainer.files.urdf import MeshPart
from rastrainer_simulator.robot.model import RobotModel

if TYPE_CHECKING:
    import trimesh

    ColoredMesh = tuple[trimesh.Trimesh, tuple[float, ...]]

LARGEST_FILE = 50 * 2**20
MAX_TRIANGLES = 500_000
FARTHEST = 10.0


def load_meshes(model: RobotModel) -> dict[str, list[ColoredMesh]]:
    """Return the meshes of every link that has some, each with its color (RGBA, 0…1).

    Vertices are in meters in the link's frame. Meshes that replace the URDF's own may also lie
    where they are on the robot at q = 0, in the base frame, as some published sets do: they are
    recognized by where they lie, and moved.
    """
    loaded = [(part, _load(part)) for part in model.meshes]
    replacements = [(part.link, mesh) for part, mesh in loaded if part.replaced]
    bases = [np.eye(4)]
    for joint in model.joints:
        bases.append(bases[-1] @ joint.origin)
    poses = {link.name: bases[link.joint] @ link.offset for link in model.links}
    if _lie_in_base_frame(model, poses, replacements):
        for link, mesh in replacements:
            mesh.apply_transform(np.linalg.inv(poses[link]))
    meshes: dict[str, list[ColoredMesh]] = {}
    for part, mesh in loaded:
        meshes.setdefault(part.link, []).append((mesh, part.color))
    return meshes


def _load(part: MeshPart) -> trimesh.Trimesh:
    import trimesh

    kind = part.path.suffix[1:].lower()
    try:
        data = read_bytes(part.path, LARGEST_FILE)
    except InputError as error:
        raise InputError(f"The mesh of {part.link} cannot be used: {error}") from None
    try:
        # Loaded from bytes, a mesh cannot refer to further files.
        mesh = trimesh.load_mesh(io.BytesIO(data), file_type=kind, process=False)
        vertices, faces = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    except Exception as error:  # a hostile file can break the parser anywhere
        raise InputError(
            f"{part.path} cannot be read as a {kind.upper()} mesh ({type(error).__name__})."
        ) from error
    if len(faces) == 0:
        raise InputError(f"{part.path} holds no triangles; it should hold a surface mesh.")
    if len(faces) > MAX_TRIANGLES:
        raise InputError(f"{part.path} has {len(faces)} triangles; at most {MAX_TRIANGLES} fit.")
    is_surface = vertices.shape[1:] == faces.shape[1:] == (3,)
    if not is_surface or faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(f"{part.path} has faces that are not triangles of its vertices.")
    if not np.all(np.abs(vertices) <= FARTHEST):
        raise InputError(
            f"{part.path} has vertices that are not finite or beyond {FARTHEST:g} m; robot meshes "
            "should be in meters."
        )
    mesh = trimesh.Trimesh(vertices, faces, process=False)
    mesh.merge_vertices()
    return mesh.apply_transform(part.origin)


def _lie_in_base_frame(
    model: RobotModel, poses: dict[str, np.ndarray], meshes: Iterable[tuple[str, trimesh.Trimesh]]
) -> bool:
    """Return whether meshes are on the outstretched robot rather than around their links' origins.

    `poses` are the links' (4, 4) at q = 0, m. A link's mesh is about the middle between its own
    and the next joint.
    """
    ends = [*(joint.origin for joint in model.joints), model.tip.offset]
    middles = {
        link.name: (np.linalg.inv(link.offset) @ ends[link.joint])[:3, 3] / 2
        for link in model.links
    }
    in_link = in_base = 0.0
    for link, mesh in meshes:
        center = mesh.bounds.mean(axis=0)
        on_robot = poses[link][:3, :3] @ middles[link] + poses[link][:3, 3]
        in_link += float(np.linalg.norm(center - middles[link]))
        in_base += float(np.linalg.norm(center - on_robot))
    return in_base < in_link
