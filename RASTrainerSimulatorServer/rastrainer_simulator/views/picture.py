"""Render the robot at the head, in its room, into a picture."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer.scenario import Camera
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.scene.nodes import Node
from rastrainer_simulator.views.lighting import light_room
from rastrainer_simulator.views.moment import Moment
from rastrainer_simulator.views.node_actors import node_actors
from rastrainer_simulator.views.offscreen import OffscreenWindow, write_png

INSET_SHARE = 0.31
FRAME_SHARE = 0.006


def render_picture(
    path: Path,
    nodes: Sequence[Node],
    robot: RobotModel,
    moment: Moment,
    camera: Camera,
    inset: Camera | None = None,
    size: tuple[int, int] = (1600, 900),
) -> None:
    """Write a PNG of a scene at one moment, in place of an older one.

    `nodes` are the scene's, as `scene_nodes` gives them, and `robot` is the one among them; the
    cameras are a scenario's; `inset` is a second view, laid into the upper right corner; `size` is
    the picture's width and height in pixels. Takes some seconds where VTK renders in software.

    Raises:
        InputError: the picture cannot be written.
    """
    renderer = vtkRenderer()
    for actor in node_actors(nodes, moment.poses(robot), moment.looks()):
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
