"""Render the robot at the head, in its room, into a picture."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer.protocol import Proximity
from rastrainer.scenario import Camera, Furniture
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.views.head_actors import ShownHead, head_actors
from rastrainer_simulator.views.lighting import light_room
from rastrainer_simulator.views.offscreen import OffscreenWindow, write_png
from rastrainer_simulator.views.robot_actors import robot_actors
from rastrainer_simulator.views.room import head_stand, room

INSET_SHARE = 0.31
FRAME_SHARE = 0.006


def render_robot_picture(
    path: Path,
    robot: RobotModel,
    link_to_world: Mapping[str, np.ndarray],
    head: ShownHead,
    furniture: Furniture,
    camera: Camera,
    inset: Camera | None = None,
    proximity: Proximity = Proximity.FREE,
    size: tuple[int, int] = (1600, 900),
) -> None:
    """Write a PNG of the robot at the head, in place of an older one.

    `link_to_world` has a (4, 4) float pose in metres for every link, as `Kinematics.links` returns
    them; `furniture` and the cameras are a scenario's; `inset` is a second view, laid into the
    upper right corner; `size` is the picture's width and height in pixels. Takes some seconds where
    VTK renders in software.

    Raises:
        InputError: the picture cannot be written, or a mesh of the robot cannot be read.
    """
    renderer = vtkRenderer()
    shown = (
        *room(furniture),
        *head_actors(head),
        *head_stand(head, furniture),
        *robot_actors(robot, link_to_world, proximity),
    )
    for actor in shown:
        renderer.AddActor(actor)
    light_room(renderer)
    window = OffscreenWindow(renderer)
    pixels = window.frame(camera, size)
    if inset:
        width, height = (round(INSET_SHARE * length) for length in size)
        _lay_in_corner(pixels, window.frame(inset, (width, height)))
    window.close()
    write_png(pixels, path)


def _lay_in_corner(pixels: np.ndarray, inset: np.ndarray) -> None:
    """Lay a framed inset over the upper right corner; both (height, width, 3) uint8."""
    frame = max(1, round(FRAME_SHARE * pixels.shape[0]))
    margin = 3 * frame
    height, width = inset.shape[:2]
    left = pixels.shape[1] - margin - width - 2 * frame
    pixels[margin : margin + height + 2 * frame, left : left + width + 2 * frame] = 255
    top, left = margin + frame, left + frame
    pixels[top : top + height, left : left + width] = inset
