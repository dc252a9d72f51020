"""The commands that move the arm, from the wire's mm to the simulation's m."""

from __future__ import annotations

from rastrainer.protocol import CommandName
from rastrainer_simulator.operator_input import Command
from rastrainer_simulator.teleoperation.axes import Axes
from rastrainer_simulator.teleoperation.commanded_motion import (
    CommandedMotion,
    JogCommand,
    MoveCommand,
)
from rastrainer_simulator.vectors import Vector, length, scale, unit

MM = 1000.0


def commanded_motion(command: Command, camera: Axes, tool: Axes) -> CommandedMotion:
    """Return the motion that Jog or MoveTipTo asks for.

    The frame "camera" is right, forward and up as the camera sees them, "tool" the axes of the
    tool's tip; both as they are when the command arrives.
    """
    arguments = command.arguments
    if command.name == CommandName.JOG:
        velocity = scale(arguments["velocityMmS"], 1.0 / MM)
        axes = {"camera": camera, "tool": tool}.get(arguments["frame"])
        velocity = axes.to_world(velocity) if axes else velocity
        return JogCommand(velocity, arguments["durationS"])
    return MoveCommand(
        position=scale(arguments["positionMm"], 1.0 / MM),
        speed=arguments["speedMmS"] / MM,
        direction=_direction(arguments["direction"]),
    )


def _direction(asked: Vector | None) -> Vector | None:
    """Return a unit vector; one without length asks for nothing."""
    return None if asked is None or length(asked) < 1e-9 else unit(asked)
