"""Look through a scenario's camera."""

from __future__ import annotations

from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer.scenario import Camera

MM_IN_M = 1000.0


def look_through(camera: Camera, renderer: vtkRenderer) -> None:
    """Set a renderer's camera; the scenario's is in mm, what is rendered in metres."""
    view = renderer.GetActiveCamera()
    view.SetPosition(*(camera.position / MM_IN_M))
    view.SetFocalPoint(*(camera.focal_point / MM_IN_M))
    view.SetViewUp(*camera.view_up)
    view.SetViewAngle(camera.view_angle_deg)
    renderer.ResetCameraClippingRange()
