"""The iiwa 7's links 1 to 7: closed parts by color, each in its link's frame, in mm."""

from pathlib import Path

import numpy as np
import trimesh
from iiwa7_sections import ARM, ARM_RADIUS, ARM_SEAM, FLANGE_PROFILE, HAND, HAND_SEAM, WRIST
from solids import Station, box, cylinder, difference, enclosing, loft, moved, revolve, trim
from trimesh.convex import convex_hull

from rastrainer.files.urdf import read_urdf
from rastrainer.transforms import MM_PER_M

Parts = dict[str, trimesh.Trimesh]

JOINTS = read_urdf(Path(__file__).with_name("iiwa7") / "iiwa7.urdf").joints
SEAM_GAP = 1.4
SEAM_DEPTH = 2.0
RING_WIDTH = 7.0
RING_HEIGHT = 0.5
RING_SEGMENTS = 40

# How far the pan joint's end of an arm shell is below (links 1, 3) or above (2, 4) the tilt joint.
ARM_ENDS = {1: -182.5, 2: -184.5, 3: -215.0, 4: -184.5}


def shells(rings: int, segments: int) -> dict[int, Parts]:
    """Return the parts of links 1 to 7 by color, lofted with the given resolution."""
    made = {link: _shell(link, rings, segments) for link in range(1, 7)}
    parts = {
        **{link: _ringed(made[link], ARM[-1]) for link in (1, 3)},
        **{link: _covered(made[link], ARM_SEAM) for link in (2, 4)},
        5: _ringed(made[5], WRIST[-1]),
        6: _covered(made[6], HAND_SEAM),
    }
    placed = {
        link: {color: _placed(part, link) for color, part in colored.items()}
        for link, colored in parts.items()
    }
    # Link 7 is the media flange with windows, bolt slots and bore.
    body = revolve(FLANGE_PROFILE, segments)
    windows = [
        moved(box((43.4, -6.0, 10.5), (60.0, 6.0, 20.5)), turn_z_deg=angle)
        for angle in (-45, 0, 45, 135, 180, 225)
    ]
    slots = [
        moved(box((43.2, -2.8, 10.5), (60.0, 2.8, 24.5)), turn_z_deg=angle)
        for angle in (-67.5, -22.5, 22.5, 67.5, 112.5, 157.5, 202.5, 247.5)
    ]
    return {
        **placed,
        7: {"metal": difference(body, cylinder(15.5, 29.0, 40.0, 24), *windows, *slots)},
    }


def plain_shells(rings: int, segments: int) -> dict[int, trimesh.Trimesh]:
    """Return links 1 to 7, each in one piece without seams that roughly encloses its parts."""
    flange = FLANGE_PROFILE[1::3] + FLANGE_PROFILE[-2:]
    placed = {
        link: _placed(_shell(link, rings, segments, enclosing=True), link) for link in range(1, 7)
    }
    return {**placed, 7: revolve(enclosing(flange, segments), segments)}


def _shell(link: int, rings: int, segments: int, enclosing: bool = False) -> trimesh.Trimesh:
    """Return the shell of link 1 to 6 about its tilt joint; links 2 and 4 are turned over."""
    stations = {5: WRIST, 6: HAND}.get(link)
    if stations is None:
        end = Station((ARM_RADIUS, ARM_ENDS[link]), (-ARM_RADIUS, ARM_ENDS[link]), ARM_RADIUS)
        stations = (end, *ARM)
    shell = loft(stations, rings, segments, enclosing)
    return shell.apply_transform(np.diag([1.0, -1.0, -1.0, 1.0])) if link in (2, 4) else shell


def _placed(part: trimesh.Trimesh, link: int) -> trimesh.Trimesh:
    """Move a part from its tilt joint to its link's frame: at the link's far end or at its own."""
    if link % 2:
        center = (0.0, 0.0, JOINTS[link].origin[2, 3] * MM_PER_M)
    else:
        center = (0.0, -JOINTS[link - 1].origin[1, 3] * MM_PER_M, 0.0)
    return moved(part, center, 180.0 if link in (3, 4) else 0.0)


def _ringed(shell: trimesh.Trimesh, face: Station) -> Parts:
    """Lay an orange ring around the shell's end at the tilt joint, the round section `face`."""
    radius, y = face.half_width + RING_HEIGHT, face.inner[0]
    outline = ((radius - 0.8, y - RING_WIDTH), (radius, y - RING_WIDTH + 1.0), (radius, y - 1.2))
    ring = revolve((*outline, (radius - 0.9, y - 0.2)), RING_SEGMENTS)
    upright = trimesh.transformations.rotation_matrix(-np.pi / 2, (1, 0, 0))
    return {"gray": shell, "orange": ring.apply_transform(upright)}


def _covered(
    shell: trimesh.Trimesh, line: tuple[tuple[float, float], tuple[float, float]]
) -> Parts:
    """Set an orange cover off the shell beyond the plane through `line` and the x direction."""
    (y0, z0), (y1, z1) = line
    normal = np.array([0.0, z1 - z0, y0 - y1]) / np.hypot(z1 - z0, y0 - y1)
    offset = float(normal @ (0.0, y0, z0))
    low, high = offset - SEAM_GAP / 2, offset + SEAM_GAP / 2
    behind, before = trim(shell, -normal, -low), trim(shell, normal, high)
    # A recessed seam separates the two.
    slab = trim(trim(shell, normal, low), -normal, -high).vertices
    across = slab - np.outer(slab @ normal, normal)
    spokes = across - across.mean(axis=0)
    shrink = SEAM_DEPTH / np.linalg.norm(spokes, axis=1, keepdims=True)
    return {"gray": behind, "orange": before, "dark": convex_hull(slab - spokes * shrink)}
