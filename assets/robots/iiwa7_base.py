"""The base of the iiwa 7: flared column, mounting lugs, connector box and panel, in mm."""

import numpy as np
import trimesh
from iiwa7_sections import BASE_FLARE
from solids import box, cylinder, difference, enclosing, moved, revolve, union
from trimesh.convex import convex_hull

PANEL_X = -112.8
LUG_ANGLES = (45, 135, 225, 315)
LUG_RADIUS = 89.5
LUG_WIDTH = 10.5
LUG_FLOOR = 11.5
BOLT_RADIUS = 6.5


def base(segments: int) -> dict[str, trimesh.Trimesh]:
    """Return the parts of link 0 by color."""
    body = union(revolve(BASE_FLARE, segments), _connector_box())
    # The upright slot over a mounting lug, open to the outside, and its bolt.
    well = moved(cylinder(LUG_WIDTH, LUG_FLOOR, 130.0, 24), (LUG_RADIUS, 0.0, 0.0))
    pocket = union(well, box((LUG_RADIUS, -LUG_WIDTH, LUG_FLOOR), (140.0, LUG_WIDTH, 130.0)))
    head = cylinder(BOLT_RADIUS, LUG_FLOOR - 1.0, LUG_FLOOR + 6.5, 16)
    socket = cylinder(3.0, LUG_FLOOR + 3.0, LUG_FLOOR + 10.0, 6)
    bolt = moved(difference(head, socket), (LUG_RADIUS + 0.5, 0.0, 0.0))
    lugs, bolts = (
        [moved(part, turn_z_deg=angle) for angle in LUG_ANGLES] for part in (pocket, bolt)
    )
    recess = _plate(PANEL_X - 1.0, PANEL_X + 1.5, 0.0)
    # The panel's connectors: five round, three large and two small, and a flat connector.
    places = [(y, 38.0, 11.0) for y in (-27.0, 0.0, 27.0)] + [
        (y, 112.0, 8.0) for y in (-17.0, 17.0)
    ]
    flat = box((PANEL_X - 2.0, -22.0, 66.0), (PANEL_X + 2.0, 22.0, 88.0))
    return {
        "gray": difference(body, *lugs, recess),
        "dark": trimesh.util.concatenate([*bolts, _plate(PANEL_X + 0.4, PANEL_X + 2.5, 0.6)]),
        "metal": trimesh.util.concatenate([flat, *(_socket(*place) for place in places)]),
    }


def plain_base(segments: int) -> trimesh.Trimesh:
    """Return the base in one piece, without details, that roughly encloses its parts."""
    flare = enclosing(BASE_FLARE[1::2], segments)
    return union(revolve(((flare[0][0], 0.0), *flare), segments), _connector_box())


def _connector_box() -> trimesh.Trimesh:
    """Return the box behind the column, widening downward, with an arched top."""
    half = ((62.5, 3.0), (44.5, 143.0), (40.0, 148.0), (26.0, 150.6), (0.0, 152.0))
    outline = np.array([*half, *((-y, z) for y, z in half)])
    back = np.column_stack([np.full(len(outline), PANEL_X), outline])
    front = np.column_stack([np.full(len(outline), -50.0), outline * (1.04, 1.0)])
    return convex_hull(np.vstack([back, front]))


def _plate(low: float, high: float, inset: float) -> trimesh.Trimesh:
    half = ((50.0 - inset, 14.0 + inset), (37.5 - inset, 134.0 - inset))
    outline = np.array([*half, *((-y, z) for y, z in half)])
    ends = [np.column_stack([np.full(len(outline), x), outline]) for x in (low, high)]
    return convex_hull(np.vstack(ends))


def _socket(y: float, z: float, radius: float) -> trimesh.Trimesh:
    """Return a round socket that stands out of the panel, its axis along x."""
    ring = difference(cylinder(radius, -4.0, 3.0, 16), cylinder(radius - 2.5, -9.0, -1.0, 16))
    lying = ring.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0)))
    return moved(lying, (PANEL_X, y, z))
