"""Which camera is chosen, what is planned, and where the head's stand is."""

from __future__ import annotations

import numpy as np

from rastrainer.scenario.scenario import Scenario
from rastrainer_simulator.state import PlanInWorld
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
        self.planned_target: PlanInWorld | None = None

    @property
    def camera_axes(self) -> Axes:
        """Right, forward and up as the chosen camera sees them."""
        return self._axes_of_cameras[self.camera]

    @property
    def stick_axes(self) -> Axes:
        """Right, forward and up as the sticks mean them."""
        return self.camera_axes if self._choice is AxesChoice.CAMERA else ROBOT_AXES


def stand_pose(head_to_world: np.ndarray, base: np.ndarray) -> np.ndarray:
    """Return StandToWorld, (4, 4) float, m; `base` is the middle of the head's base, (3,) float."""
    stand_to_world = np.eye(4)
    stand_to_world[:3, 3] = head_to_world[:3, :3] @ base + head_to_world[:3, 3]
    return stand_to_world
