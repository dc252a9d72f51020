"""Make the URDF and the meshes of the iiwa 7 with its pointer tool, always the same bytes.

python assets/robots/make_iiwa7.py [--output FOLDER]
"""

import argparse
import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
from iiwa7_base import base, plain_base
from iiwa7_dimensions import (
    ARM,
    COLORS,
    FLANGE_OFFSET,
    JOINTS,
    LINK_NAMES,
    LINK_PREFIX,
    MASSES,
    TOOL_LENGTH,
    TOOL_LINK,
    TOOL_TIP_LINK,
)
from iiwa7_shells import plain_shells, shells
from iiwa7_urdf import LinkBody, urdf_text
from pointer_tool import plain_tool, tip, tool

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.robot_shape import robot_shape
from rastrainer_simulator.robot.model import PREPARED_NAME, robot_model

RINGS = 25
SEGMENTS = 40
ROUND_SEGMENTS = 44
TOOL_SEGMENTS = 18
COARSE_RINGS = 14
COARSE_SEGMENTS = 12
MESH_DECIMALS = 6


def main() -> None:
    """Write `iiwa7.urdf`, `meshes` and `prepared.json` into a folder, in place of older files."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "iiwa7")
    folder = parser.parse_args().output
    for old in (folder / "meshes").rglob("*.stl"):
        old.unlink()
    visuals, solids = visual_parts(), plain_parts(RINGS, SEGMENTS)
    collisions = plain_parts(COARSE_RINGS, COARSE_SEGMENTS)
    bodies = {}
    for link in LINK_NAMES:
        short = link.removeprefix("iiwa_")
        files = [
            (_write(part, folder, f"visual/{short}_{color}.stl"), color)
            for color, part in visuals[link].items()
        ]
        collision = _write(collisions[link], folder, f"collision/{short}.stl")
        # The link's mass is spread evenly over its solid.
        mass, solid = MASSES[link], solids[link].copy()
        solid.density = mass / solid.volume
        inertia = solid.moment_inertia[np.triu_indices(3)]
        bodies[link] = LinkBody(
            files, collision, mass, _rounded(solid.center_mass, 4), _rounded(inertia, 6)
        )
    tip_file = _write(visuals[TOOL_TIP_LINK]["blue"], folder, "visual/tool_tip_blue.stl")
    text = urdf_text(bodies, (tip_file, "blue"))
    (folder / "iiwa7.urdf").write_text(text, encoding="utf-8", newline="\n")
    model = model_json(bodies, tip_file)
    shape = asdict(robot_shape(robot_model(model, folder)))
    text = json.dumps(
        {"model": model, "shape": shape}, indent=1, sort_keys=True, default=np.ndarray.tolist
    )
    (folder / PREPARED_NAME).write_text(text + "\n", encoding="utf-8", newline="\n")


def model_json(bodies: Mapping[str, LinkBody], tip_file: str) -> dict[str, Any]:
    """Return the JSON object that `robot_model` reads: what the URDF says."""
    joints = [
        {
            "name": joint.name,
            "origin": shifted(*joint.origin),
            "axis": np.array(joint.axis, dtype=float),
            "lower": -math.radians(joint.limit_deg),
            "upper": math.radians(joint.limit_deg),
            "velocity": math.radians(joint.speed_deg_s),
        }
        for joint in JOINTS
    ]
    offsets = {TOOL_LINK: FLANGE_OFFSET, TOOL_TIP_LINK: FLANGE_OFFSET + TOOL_LENGTH}
    links = [
        {"name": name, "joint": min(number, 7), "offset": shifted(0.0, 0.0, offsets.get(name, 0.0))}
        for number, name in enumerate((*LINK_NAMES, TOOL_TIP_LINK))
    ]
    files = [
        *((link, "visual", file, color) for link in bodies for file, color in bodies[link].visuals),
        *((link, "collision", body.collision, "") for link, body in bodies.items()),
        (TOOL_TIP_LINK, "visual", tip_file, "blue"),
    ]
    meshes = [
        {
            "link": link,
            "kind": kind,
            "path": file,
            "origin": np.eye(4),
            "scale": [1.0, 1.0, 1.0],
            "color": COLORS.get(color, (0.8, 0.8, 0.8, 1.0)),
        }
        for link, kind, file, color in files
    ]
    names = {"name": "iiwa7", "tip": TOOL_TIP_LINK}
    arm = ARM | {"signs": [float(sum(joint.axis)) for joint in JOINTS]}
    return {**names, "arm": arm, "joints": joints, "links": links, "meshes": meshes}


def shifted(x: float, y: float, z: float) -> np.ndarray:
    """Return a frame (4, 4) that is parallel to the frame before, m."""
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


def visual_parts() -> dict[str, dict[str, trimesh.Trimesh]]:
    """Return the colored parts of each link, in its frame, in meters."""
    links = {0: base(ROUND_SEGMENTS), **shells(RINGS, SEGMENTS)}
    parts = {
        **{f"{LINK_PREFIX}{number}": link_parts for number, link_parts in links.items()},
        TOOL_LINK: tool(TOOL_SEGMENTS),
        TOOL_TIP_LINK: {"blue": tip(TOOL_SEGMENTS)},
    }
    return {
        link: {color: in_meters(part) for color, part in link_parts.items()}
        for link, link_parts in parts.items()
    }


def plain_parts(rings: int, segments: int) -> dict[str, trimesh.Trimesh]:
    """Return each link in one piece, in its frame, in meters: for collisions and inertia."""
    links = {0: plain_base(segments), **plain_shells(rings, segments)}
    parts = {f"{LINK_PREFIX}{number}": in_meters(part) for number, part in links.items()}
    return {**parts, TOOL_LINK: in_meters(plain_tool(segments))}


def in_meters(part: trimesh.Trimesh) -> trimesh.Trimesh:
    """Round a part to whole micrometers, in meters, its triangles in a fixed order.

    Rounding and sorting take out what could differ from machine to machine: the last bits of
    sines, and the order in which cuts and hulls return their triangles.
    """
    vertices = np.round(part.vertices / MM_PER_M, MESH_DECIMALS) + 0.0
    vertices, index = np.unique(vertices, axis=0, return_inverse=True)
    faces = index.reshape(-1)[part.faces]
    a, b, c = faces.T
    faces = faces[(a != b) & (b != c) & (c != a)]
    first = np.argmin(faces, axis=1)
    faces = np.take_along_axis(faces, (first[:, None] + np.arange(3)) % 3, axis=1)
    return trimesh.Trimesh(vertices, faces[np.lexsort(faces.T[::-1])], process=False)


def _write(part: trimesh.Trimesh, folder: Path, name: str) -> str:
    path = folder / "meshes" / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(trimesh.exchange.stl.export_stl(part))
    return f"meshes/{name}"


def _rounded(values: np.ndarray, decimals: int) -> tuple[float, ...]:
    """Round away what a uniform density cannot know, and minus zero."""
    return tuple(float(value) + 0.0 for value in np.round(values, decimals))


if __name__ == "__main__":
    main()
