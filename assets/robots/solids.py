"""Closed solids: revolved outlines, boxes, prisms, their cuts and unions, and lofted shells."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import manifold3d
import numpy as np
import trimesh
from scipy.interpolate import PchipInterpolator

from rastrainer_simulator.scene.surfaces import stitched

Outline = Sequence[tuple[float, float]]


def revolve(outline: Outline, segments: int) -> trimesh.Trimesh:
    """Turn an outline of (radius, z) points, from bottom to top, about the z axis."""
    closed = np.array([(0.0, outline[0][1]), *outline, (0.0, outline[-1][1])])
    return trimesh.creation.revolve(closed, sections=segments)


def enclosing(outline: Outline, segments: int) -> Outline:
    """Widen an outline so that the flat sides of its solid touch the round one it stands for."""
    return [(radius / np.cos(np.pi / segments), z) for radius, z in outline]


def cylinder(radius: float, bottom: float, top: float, segments: int) -> trimesh.Trimesh:
    """Return a cylinder about the z axis between two heights."""
    return revolve(((radius, bottom), (radius, top)), segments)


def box(low: Sequence[float], high: Sequence[float]) -> trimesh.Trimesh:
    """Return the box between two corners."""
    return trimesh.creation.box(bounds=[low, high])


def union(*solids: trimesh.Trimesh) -> trimesh.Trimesh:
    return trimesh.boolean.union(list(solids), engine="manifold")


def difference(solid: trimesh.Trimesh, *tools: trimesh.Trimesh) -> trimesh.Trimesh:
    return trimesh.boolean.difference([solid, *tools], engine="manifold")


def trim(solid: trimesh.Trimesh, normal: Sequence[float], offset: float) -> trimesh.Trimesh:
    """Keep the part on the side of a plane that its unit `normal` points to, and close the cut.

    The plane holds the points p with normal · p = offset.
    """
    mesh = manifold3d.Mesh(
        np.asarray(solid.vertices, dtype=np.float32), np.asarray(solid.faces, dtype=np.uint32)
    )
    kept = manifold3d.Manifold(mesh).trim_by_plane(tuple(normal), offset).to_mesh()
    return trimesh.Trimesh(kept.vert_properties[:, :3], kept.tri_verts, process=False)


def moved(
    solid: trimesh.Trimesh, offset: Sequence[float] = (0, 0, 0), turn_z_deg: float = 0.0
) -> trimesh.Trimesh:
    """Return a copy turned about the z axis, then shifted."""
    matrix = trimesh.transformations.rotation_matrix(np.radians(turn_z_deg), (0, 0, 1))
    matrix[:3, 3] = offset
    return solid.copy().apply_transform(matrix)


CHAMFER = 1.2


@dataclass(frozen=True)
class Station:
    """One section of a shell that is symmetric about the plane x = 0; lengths in mm.

    The section's plane holds the x direction and the chord from `inner` to `outer`, two points
    (y, z) of the outline in the symmetry plane: the concave and the convex side of the bend. Its
    outline is |x / half_width|^n + |s / a|^n = 1 with s counted along the chord from the widest
    place, which lies at the fraction `widest` of the chord; a and n differ on the two sides of it.
    """

    inner: tuple[float, float]
    outer: tuple[float, float]
    half_width: float
    widest: float = 0.5
    inner_exponent: float = 2.0
    outer_exponent: float = 2.0


def loft(
    stations: Sequence[Station], rings: int, segments: int, enclosing: bool = False
) -> trimesh.Trimesh:
    """Return a closed shell through `stations`, its two flat ends chamfered; in mm.

    The corners of each section lie on its outline; the corners of an `enclosing` shell lie so far
    outside that its sides touch the outline.

    Every number of a section follows a monotone cubic between the stations, so that the shell
    neither overshoots nor kinks. Rings are spread evenly over the mean of both outlines' lengths.
    """
    rows = np.array([np.hstack(astuple(station)) for station in stations])
    steps = np.linalg.norm(np.diff(rows[:, 0:2], axis=0), axis=1)
    steps += np.linalg.norm(np.diff(rows[:, 2:4], axis=0), axis=1)
    lengths = np.concatenate(([0.0], np.cumsum(steps / 2)))
    curve = PchipInterpolator(lengths, rows)
    places = np.linspace(CHAMFER, lengths[-1] - CHAMFER, rings)
    scale = 1 / np.cos(np.pi / segments) if enclosing else 1.0
    sections = [_outline(row, segments, scale) for row in curve(places)]
    ends = []
    for row in (rows[0], rows[-1]):
        # Pulled inward by the chamfer, within its plane.
        outline = _outline(row, segments, scale)
        spokes = outline - outline.mean(axis=0)
        length = np.linalg.norm(spokes, axis=1, keepdims=True)
        ends.append(outline - spokes * (CHAMFER / length))
    mesh = trimesh.Trimesh(*stitched(np.array([ends[0], *sections, ends[1]])), process=False)
    if mesh.volume < 0:
        mesh.invert()
    return mesh


def _outline(row: np.ndarray, segments: int, scale: float) -> np.ndarray:
    """Return the (segments, 3) float points of one section, scaled about its chord's middle."""
    inner, outer = row[0:2], row[2:4]
    half_width, widest, inner_exponent, outer_exponent = row[4:8]
    angle = 2 * np.pi * np.arange(segments) / segments
    cosine, sine = np.cos(angle), np.sin(angle)
    power = 2 / np.where(sine >= 0, outer_exponent, inner_exponent)
    reach = np.where(sine >= 0, 1 - widest, widest)
    x = half_width * np.sign(cosine) * np.abs(cosine) ** power
    along = widest + reach * np.sign(sine) * np.abs(sine) ** power
    along = 0.5 + scale * (along - 0.5)
    return np.column_stack([scale * x, inner + along[:, None] * (outer - inner)])
