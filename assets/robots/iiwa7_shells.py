"""The iiwa 7's links 1 to 7: closed parts by color, each in its link's frame, in mm."""

from collections.abc import Callable, Sequence

import numpy as np
import trimesh
from iiwa7_dimensions import JOINTS
from iiwa7_sections import ARM, ARM_RADIUS, ARM_SEAM, FLANGE_PROFILE, HAND, HAND_SEAM, WRIST
from solids import Station, box, cylinder, difference, enclosing, hull, loft, moved, revolve, trim

from rastrainer.transforms import MM_PER_M

Parts = dict[str, trimesh.Trimesh]

SEAM_GAP = 1.4
SEAM_DEPTH = 2.0
RING_WIDTH = 7.0
RING_HEIGHT = 0.5
RING_SEGMENTS = 40

# How far the pan joint's end of an arm shell is below (links 1, 3) or above (2, 4) the tilt joint.
LOWER_ARM_ENDS = {1: -182.5, 3: -215.0}
UPPER_ARM_END = -184.5


def shells(rings: int, segments: int) -> dict[int, Parts]:
    """Return the parts of links 1 to 7 by color, lofted with the given resolution."""
    return {
        1: _lower_arm(1, 0, rings, segments),
        2: _upper_arm(2, 0, rings, segments),
        3: _lower_arm(3, 180, rings, segments),
        4: _upper_arm(4, 180, rings, segments),
        5: _wrist(rings, segments),
        6: _hand(rings, segments),
        7: {"metal": _flange(segments)},
    }


def plain_shells(rings: int, segments: int) -> dict[int, trimesh.Trimesh]:
    """Return links 1 to 7, each in one piece without seams that roughly encloses its parts."""

    def shell(stations: Sequence[Station]) -> trimesh.Trimesh:
        return loft(stations, rings, segments, enclosing=True)

    flange = FLANGE_PROFILE[1::3] + FLANGE_PROFILE[-2:]
    return {
        1: _place_lower(shell(_arm(LOWER_ARM_ENDS[1])), 1, 0),
        2: _place_upper(shell(_arm(UPPER_ARM_END)), 2, 0),
        3: _place_lower(shell(_arm(LOWER_ARM_ENDS[3])), 3, 180),
        4: _place_upper(shell(_arm(UPPER_ARM_END)), 4, 180),
        5: moved(shell(WRIST), _to_tilt(5)),
        6: moved(shell(HAND), _from_tilt(6)),
        7: revolve(enclosing(flange, segments), segments),
    }


def _arm(end: float) -> tuple[Station, ...]:
    return (Station((ARM_RADIUS, end), (-ARM_RADIUS, end), ARM_RADIUS), *ARM)


def _lower_arm(link: int, turn: float, rings: int, segments: int) -> Parts:
    shell = loft(_arm(LOWER_ARM_ENDS[link]), rings, segments)
    parts = _ringed(shell, ARM[-1])
    return _map(parts, lambda part: _place_lower(part, link, turn))


def _upper_arm(link: int, turn: float, rings: int, segments: int) -> Parts:
    shell = _turned_over(loft(_arm(UPPER_ARM_END), rings, segments))
    parts = _covered(shell, ARM_SEAM)
    return _map(parts, lambda part: moved(part, _from_tilt(link), turn))


def _wrist(rings: int, segments: int) -> Parts:
    parts = _ringed(loft(WRIST, rings, segments), WRIST[-1])
    return _map(parts, lambda part: moved(part, _to_tilt(5)))


def _hand(rings: int, segments: int) -> Parts:
    parts = _covered(loft(HAND, rings, segments), HAND_SEAM)
    return _map(parts, lambda part: moved(part, _from_tilt(6)))


def _place_lower(shell: trimesh.Trimesh, link: int, turn: float) -> trimesh.Trimesh:
    return moved(shell, _to_tilt(link), turn)


def _place_upper(shell: trimesh.Trimesh, link: int, turn: float) -> trimesh.Trimesh:
    return moved(_turned_over(shell), _from_tilt(link), turn)


def _turned_over(shell: trimesh.Trimesh) -> trimesh.Trimesh:
    return shell.copy().apply_transform(np.diag([1.0, -1.0, -1.0, 1.0]))


def _to_tilt(link: int) -> tuple[float, float, float]:
    """Return the tilt joint's center in the frame of the link whose far end it is."""
    return (0.0, 0.0, JOINTS[link].origin[2] * MM_PER_M)


def _from_tilt(link: int) -> tuple[float, float, float]:
    """Return the tilt joint's center in the frame of the link that it moves."""
    return (0.0, -JOINTS[link - 1].origin[1] * MM_PER_M, 0.0)


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
    gray, seam, cover = _split(shell, normal, float(normal @ (0.0, y0, z0)))
    return {"gray": gray, "orange": cover, "dark": seam}


def _split(
    shell: trimesh.Trimesh, normal: np.ndarray, offset: float
) -> tuple[trimesh.Trimesh, trimesh.Trimesh, trimesh.Trimesh]:
    """Cut a shell by a plane: the part behind it, a recessed seam, and the part before it."""
    low, high = offset - SEAM_GAP / 2, offset + SEAM_GAP / 2
    behind, before = trim(shell, -normal, -low), trim(shell, normal, high)
    slab = trim(trim(shell, normal, low), -normal, -high).vertices
    across = slab - np.outer(slab @ normal, normal)
    spokes = across - across.mean(axis=0)
    shrink = SEAM_DEPTH / np.linalg.norm(spokes, axis=1, keepdims=True)
    return behind, hull(slab - spokes * shrink), before


def _flange(segments: int) -> trimesh.Trimesh:
    """Return link 7: the media flange with windows, bolt slots and bore."""
    body = revolve(FLANGE_PROFILE, segments)
    windows = [
        moved(box((43.4, -6.0, 10.5), (60.0, 6.0, 20.5)), turn_z_deg=angle)
        for angle in (-45, 0, 45, 135, 180, 225)
    ]
    slots = [
        moved(box((43.2, -2.8, 10.5), (60.0, 2.8, 24.5)), turn_z_deg=angle)
        for angle in (-67.5, -22.5, 22.5, 67.5, 112.5, 157.5, 202.5, 247.5)
    ]
    return difference(body, cylinder(15.5, 29.0, 40.0, 24), *windows, *slots)


def _map(parts: Parts, place: Callable[[trimesh.Trimesh], trimesh.Trimesh]) -> Parts:
    return {color: place(part) for color, part in parts.items()}
