"""From where the scene is seen."""

from __future__ import annotations

from dataclasses import dataclass

from vtkmodules.vtkRenderingCore import vtkRenderer

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Camera:
    """A camera in World, in metres; `view_angle_deg` is that of the picture's height."""

    position: Point
    focal_point: Point
    view_angle_deg: float = 30.0

    def apply(self, renderer: vtkRenderer) -> None:
        """Look through it."""
        camera = renderer.GetActiveCamera()
        camera.SetPosition(*self.position)
        camera.SetFocalPoint(*self.focal_point)
        camera.SetViewUp(0.0, 0.0, 1.0)
        camera.SetViewAngle(self.view_angle_deg)
        renderer.ResetCameraClippingRange()


FAR = Camera((0.66, -2.35, 0.95), (0.42, 0.0, 0.33), 24.0)


def close_up(target: Point) -> Camera:
    """Return a camera in front of the face, a little above, that looks at `target` in World."""
    x, y, z = target
    return Camera((x + 0.25, y - 0.75, z + 0.28), (x, y, z), 20.0)
