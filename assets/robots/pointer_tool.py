"""The 0.2 m pointer tool: handle-like mount, chuck, slender shaft and colored tip, in mm.

The tool's frame sits on the flange with z along the A7 axis; the tip's frame at the very tip.
"""

import trimesh
from solids import enclosing, revolve

LENGTH = 200.0
SHAFT_RADIUS = 3.0
TIP_LENGTH = 22.0
POINT_RADIUS = 0.4

MOUNT = (
    (30.5, 0.0), (31.5, 1.0), (31.5, 7.0), (30.5, 8.0), (21.0, 9.5), (18.0, 13.0), (17.0, 20.0),
    (17.8, 24.0), (17.0, 28.0), (17.8, 32.0), (17.0, 36.0), (17.8, 40.0), (17.0, 44.0),
    (17.8, 48.0), (16.0, 54.0), (12.0, 62.0), (10.0, 66.0),
)  # fmt: skip
CHUCK = ((10.5, 66.0), (10.5, 72.0), (8.5, 75.0), (8.5, 80.0), (6.0, 86.0), (3.6, 92.0))


def tool(segments: int) -> dict[str, trimesh.Trimesh]:
    """Return the parts of the tool by color, without its tip."""
    shaft = (*CHUCK, (SHAFT_RADIUS, 93.0), (SHAFT_RADIUS, LENGTH - TIP_LENGTH))
    return {"dark": revolve(MOUNT, segments), "metal": revolve(shaft, segments)}


def tip(segments: int) -> trimesh.Trimesh:
    """Return the colored tip: a collar and a slender cone that ends at the tip frame's origin."""
    outline = (
        (POINT_RADIUS * 0.5, 0.0), (POINT_RADIUS, -0.3), (SHAFT_RADIUS - 0.2, -15.0),
        (SHAFT_RADIUS + 0.7, -16.0), (SHAFT_RADIUS + 0.7, -21.0), (SHAFT_RADIUS, -TIP_LENGTH),
    )  # fmt: skip
    return revolve(outline[::-1], segments)


def plain_tool(segments: int) -> trimesh.Trimesh:
    """Return the whole tool in one piece, tip included."""
    outline = ((31.5, 0.0), (31.5, 8.0), (18.0, 13.0), (17.8, 48.0), (10.5, 66.0), (8.5, 80.0))
    shaft = ((SHAFT_RADIUS, 93.0), (SHAFT_RADIUS, LENGTH - 15.0), (POINT_RADIUS, LENGTH))
    return revolve(enclosing((*outline, *shaft), segments), segments)
