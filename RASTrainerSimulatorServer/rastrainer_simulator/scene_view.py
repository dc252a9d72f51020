"""What the views show beside the arm: the camera, its axes, and the planned target."""

from __future__ import annotations

from rastrainer.scenario import Scenario
from rastrainer_simulator.state import PlannedTarget
from rastrainer_simulator.teleoperation.axes import ROBOT_AXES, Axes, AxesChoice, camera_axes


class SceneView:
    """The chosen camera and the planned target."""

    def __init__(self, scenario: Scenario, camera: str, choice: AxesChoice) -> None:
        self._choice = choice
        self._axes_of_cameras = {
            name: camera_axes(
                tuple((view.focal_point - view.position).tolist()), tuple(view.view_up.tolist())
            )
            for name, view in scenario.cameras.items()
        }
        self.camera = camera
        self.planned_target: PlannedTarget | None = None

    @property
    def camera_axes(self) -> Axes:
        """Right, forward and up as the chosen camera sees them."""
        return self._axes_of_cameras[self.camera]

    @property
    def stick_axes(self) -> Axes:
        """Right, forward and up as the sticks mean them."""
        return self.camera_axes if self._choice is AxesChoice.CAMERA else ROBOT_AXES
