"""Write nodes as a GLB file: glTF 2.0, one file."""

from __future__ import annotations

import numpy as np
import trimesh
from trimesh.visual import TextureVisuals
from trimesh.visual.material import PBRMaterial

from rastrainer_simulator.scene.materials import Material
from rastrainer_simulator.scene.nodes import Node, Surface

ROOT = "scene"
WORLD = "world"
# glTF's y is up, as World's z is; x stays.
WORLD_TO_GLTF = np.array([[1, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]], dtype=float)


def to_glb(nodes: list[Node]) -> bytes:
    """Return the GLB of nodes that stand in World.

    A node of one surface carries it; one of several has a child for each, named
    `NODE_MATERIAL`.
    """
    scene = trimesh.Scene(base_frame=ROOT)
    scene.graph.update(frame_from=ROOT, frame_to=WORLD, matrix=WORLD_TO_GLTF)
    materials: dict[Material, PBRMaterial] = {}
    for node in nodes:
        _add(scene, WORLD, node, materials)
    return scene.export(file_type="glb", include_normals=True)


def _add(
    scene: trimesh.Scene, parent: str, node: Node, materials: dict[Material, PBRMaterial]
) -> None:
    pose = np.eye(4) if node.pose is None else node.pose
    single = node.surfaces[0] if len(node.surfaces) == 1 else None
    if single is not None:
        _add_surface(scene, parent, node.name, pose, single, materials)
    else:
        scene.graph.update(frame_from=parent, frame_to=node.name, matrix=pose)
        for surface in node.surfaces:
            name = f"{node.name}_{surface.material.name}"
            _add_surface(scene, node.name, name, np.eye(4), surface, materials)
    for child in node.children:
        _add(scene, node.name, child, materials)


def _add_surface(
    scene: trimesh.Scene,
    parent: str,
    name: str,
    pose: np.ndarray,
    surface: Surface,
    materials: dict[Material, PBRMaterial],
) -> None:
    if surface.material not in materials:
        materials[surface.material] = _material(surface.material)
    mesh = trimesh.Trimesh(
        surface.vertices,
        surface.triangles,
        vertex_normals=surface.normals,
        visual=TextureVisuals(material=materials[surface.material]),
        process=False,
    )
    scene.add_geometry(
        mesh, node_name=name, geom_name=name, parent_node_name=parent, transform=pose
    )


def _material(material: Material) -> PBRMaterial:
    color = np.array(material.linear_color)
    # What glows is black to lamps: it has its own color in any light.
    base, glow = (np.zeros(3), color) if material.glowing else (color, np.zeros(3))
    return PBRMaterial(
        name=material.name,
        baseColorFactor=[*base, 1.0],
        metallicFactor=material.metallic,
        roughnessFactor=material.roughness,
        emissiveFactor=glow,
    )
