"""Viewpoints, and the smooth move of a camera from one to another."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

TRANSITION_S = 0.7


@dataclass(frozen=True)
class Viewpoint:
    """Where a camera stands; World, m; the angle is vertical, degrees.

    `aside` is how far the picture is pushed to the right, in halves of its width.
    """

    position: np.ndarray
    focal_point: np.ndarray
    view_up: np.ndarray
    angle_deg: float
    aside: float = 0.0

    @classmethod
    def from_json(cls, value: Mapping) -> Viewpoint:
        """Return a camera of the stream."""
        return cls(
            np.array(value["position"], dtype=float),
            np.array(value["focalPoint"], dtype=float),
            np.array(value["viewUp"], dtype=float),
            float(value["viewAngleDeg"]),
        )

    def toward(self, other: Viewpoint, share: float) -> Viewpoint:
        """Return a viewpoint between this and another; a share of 0 is this one, 1 the other."""
        pairs = (
            (self.position, other.position),
            (self.focal_point, other.focal_point),
            (self.view_up, other.view_up),
        )
        place, focus, up = (start + share * (end - start) for start, end in pairs)
        angle = self.angle_deg + share * (other.angle_deg - self.angle_deg)
        return Viewpoint(place, focus, up, angle, self.aside + share * (other.aside - self.aside))

    def look(self, renderer: vtkRenderer) -> None:
        """Set a renderer's camera, but for how near and how far it sees."""
        camera = renderer.GetActiveCamera()
        camera.SetPosition(*self.position)
        camera.SetFocalPoint(*self.focal_point)
        camera.SetViewUp(*self.view_up)
        camera.SetViewAngle(self.angle_deg)
        camera.SetWindowCenter(-self.aside, 0.0)


class CameraTransition:
    """The move of a camera to a viewpoint, which starts and ends gently."""

    def __init__(self, start: Viewpoint):
        self._from = self._to = start
        self._since = -TRANSITION_S

    def start(self, to: Viewpoint, now: float) -> None:
        """Move to a viewpoint from wherever the camera is at `now` (s)."""
        self._from, self._to, self._since = self.at(now), to, now

    def follow(self, to: Viewpoint) -> None:
        """Have a viewpoint that moves itself as the end of the way, or be there already."""
        self._to = to

    def is_moving(self, now: float) -> bool:
        """Return whether the camera is still moving."""
        return now - self._since < TRANSITION_S

    def at(self, now: float) -> Viewpoint:
        """Return where the camera is."""
        share = min(1.0, max(0.0, (now - self._since) / TRANSITION_S))
        return self._from.toward(self._to, share * share * (3.0 - 2.0 * share))
