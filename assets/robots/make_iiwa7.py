"""Make the meshes of the iiwa 7 with its pointer tool, always the same bytes.

python assets/robots/make_iiwa7.py [--output FOLDER]
"""

import argparse
from pathlib import Path

import numpy as np
import trimesh
from iiwa7_base import base, plain_base
from iiwa7_shells import plain_shells, shells
from pointer_tool import plain_tool, tip, tool

from rastrainer.transforms import MM_PER_M

RINGS = 25
SEGMENTS = 40
ROUND_SEGMENTS = 44
TOOL_SEGMENTS = 18
COARSE_RINGS = 14
COARSE_SEGMENTS = 12
MESH_DECIMALS = 6


def main() -> None:
    """Write the meshes into a folder: of each link a part a color, and one for collisions."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--output", type=Path, default=Path(__file__).parent / "iiwa7" / "meshes")
    folder = parser.parse_args().output
    visual = {
        "link_0": base(ROUND_SEGMENTS),
        **{f"link_{number}": parts for number, parts in shells(RINGS, SEGMENTS).items()},
        "link_tool": tool(TOOL_SEGMENTS),
        "tool_tip": {"blue": tip(TOOL_SEGMENTS)},
    }
    for link, parts in visual.items():
        for color, part in parts.items():
            write(part, folder / "visual" / f"{link}_{color}.stl")
    plain = {0: plain_base(COARSE_SEGMENTS), **plain_shells(COARSE_RINGS, COARSE_SEGMENTS)}
    for link, part in (*plain.items(), ("tool", plain_tool(COARSE_SEGMENTS))):
        write(part, folder / "collision" / f"link_{link}.stl")


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


def write(part: trimesh.Trimesh, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(trimesh.exchange.stl.export_stl(in_meters(part)))


if __name__ == "__main__":
    main()
