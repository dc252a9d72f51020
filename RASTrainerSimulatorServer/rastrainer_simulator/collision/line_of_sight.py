"""The lines of sight from an eye past the head and one posture of the arm."""

from __future__ import annotations

import numpy as np

from rastrainer_simulator.collision.clearance import HeadClearance
from rastrainer_simulator.collision.robot_shape import ArmCapsules, PosedArm
from rastrainer_simulator.vectors import Vector

ABOVE_TABLE_M = 0.02
"""An eye nearer to the table than this would look through its top."""
_TINY = 1e-12


def sight_clearances(
    eyes: np.ndarray, places: np.ndarray, ends: np.ndarray, radii: np.ndarray
) -> np.ndarray:
    """Return how far m lines of sight pass n capsules, (m, n) float, m; below zero: covered.

    Lines begin at `eyes` and end at `places`, (m, 3) float each; `ends` (n, 2, 3) and `radii` (n,)
    are the capsules'. It is `vectors.segment_distance` for all pairs at once.
    """
    starts, axes = ends[:, 0], ends[:, 1] - ends[:, 0]
    lines = places - eyes
    uu = np.einsum("mi,mi->m", lines, lines)[:, None] + _TINY
    vv = np.einsum("ni,ni->n", axes, axes) + _TINY
    uv = lines @ axes.T
    between = eyes[:, None] - starts
    uw = np.einsum("mi,mni->mn", lines, between)
    vw = np.einsum("ni,mni->mn", axes, between)
    area = np.maximum(uu * vv - uv * uv, _TINY * uu * vv)
    s = np.clip((uv * vw - vv * uw) / area, 0.0, 1.0)
    t = np.clip((uv * s + vw) / vv, 0.0, 1.0)
    s = np.clip((uv * t - uw) / uu, 0.0, 1.0)
    apart = between + s[..., None] * lines[:, None] - t[..., None] * axes
    return np.sqrt(np.einsum("mni,mni->mn", apart, apart)) - radii


class LineOfSight:
    """Finds what the head, the table and one posture of the arm leave visible; World, m."""

    def __init__(
        self, head: HeadClearance, arm: ArmCapsules, posed: PosedArm, table_height: float
    ) -> None:
        self._head = head
        count = arm.link_count
        self._links = posed.ends[:count], arm.radii[:count]
        self._tool = posed.ends[count:], arm.radii[count:]
        self._lowest = table_height + ABOVE_TABLE_M

    def is_free(self, eye: Vector, place: Vector) -> bool:
        """Return whether a point is seen from an eye past head, links and table.

        The tool does not count.
        """
        off_links = self.off_links(np.array([eye]), np.array(place))
        return self.is_past_head(eye, place) and bool(off_links[0] > 0.0)

    def is_past_head(self, eye: Vector, place: Vector) -> bool:
        return eye[2] > self._lowest and not self._head.is_crossed(eye, place)

    def off_links(self, eyes: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Return how far the lines from eyes (m, 3) to a place (3,) pass the links, (m,), m."""
        return sight_clearances(eyes, np.broadcast_to(place, eyes.shape), *self._links).min(axis=1)

    def off_tool(self, eyes: np.ndarray, place: np.ndarray) -> np.ndarray:
        """Return how far the lines from eyes (m, 3) to a place (3,) pass the tool, (m,), m."""
        return sight_clearances(eyes, np.broadcast_to(place, eyes.shape), *self._tool).min(axis=1)
