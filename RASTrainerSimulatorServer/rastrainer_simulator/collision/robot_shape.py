"""The robot as collisions see it: capsules about its links, and a tapered row along its tool."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.collision.capsules import (
    Capsule,
    capsules_along,
    covering_capsules,
    surface_points,
)
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import Link, RobotModel

SHAFT_START = 0.003
"""Distance behind the tip, m, from which the tool is a shaft that must not touch the head."""

_LINK_SPACING = 0.01
_TOOL_SPACING = 0.0005


@dataclass(frozen=True)
class LinkShape:
    """One link: its capsules in its own frame; `joint` tells how many joints are before it."""

    name: str
    joint: int
    capsules: tuple[Capsule, ...]


@dataclass(frozen=True)
class RobotShape:
    """The arm's links, and the tool without its last 3 mm, its capsules in its tip's frame."""

    links: tuple[LinkShape, ...]
    tool: LinkShape
    tip_name: str


def robot_shape(model: RobotModel) -> RobotShape:
    """Return the capsules that cover the collision meshes of a robot.

    The tool is the link behind the last joint whose mesh comes nearest to the tip. A link without
    a collision mesh collides with nothing, as in any URDF.

    Raises:
        InputError: a mesh cannot be read.
    """
    links = {link.name: link for link in model.links}
    meshes = {
        name: [(np.asarray(mesh.vertices), np.asarray(mesh.faces)) for mesh, _ in parts]
        for name, parts in load_meshes(model, "collision").items()
    }
    tool = _tool_name(model, meshes)
    tool_to_tip = np.linalg.inv(model.tip.offset) @ links[tool].offset
    tool_capsules = _tool_capsules(
        _moved(tool_to_tip, _points(meshes.pop(tool), _TOOL_SPACING)), _shaft_to_tip(model)
    )
    shapes = tuple(
        LinkShape(
            name, links[name].joint, covering_capsules(_points(parts, _LINK_SPACING), _LINK_SPACING)
        )
        for name, parts in meshes.items()
    )
    return RobotShape(shapes, LinkShape(tool, links[tool].joint, tool_capsules), model.tip.name)


def _points(parts: list[tuple[np.ndarray, np.ndarray]], spacing: float) -> np.ndarray:
    return np.concatenate([surface_points(*part, spacing) for part in parts])


def _tool_name(model: RobotModel, meshes: dict[str, list[tuple[np.ndarray, np.ndarray]]]) -> str:
    def distance_to_tip(link: Link) -> float:
        tip = (np.linalg.inv(link.offset) @ model.tip.offset)[:3, 3]
        return min(np.linalg.norm(v - tip, axis=1).min() for v, _ in meshes[link.name])

    behind = [link for link in model.links if link.joint == 7 and link.name in meshes]
    return min(behind, key=distance_to_tip).name


def _tool_capsules(points: np.ndarray, shaft_to_tip: np.ndarray) -> tuple[Capsule, ...]:
    in_shaft_frame = _moved(np.linalg.inv(shaft_to_tip), points)
    return tuple(
        Capsule(*_moved(shaft_to_tip, np.array([capsule.start, capsule.end])), capsule.radius)
        for capsule in capsules_along(in_shaft_frame, SHAFT_START)
    )


def _shaft_to_tip(model: RobotModel) -> np.ndarray:
    """Return the pose (4, 4), in the tip's frame, of a frame at the tip whose z runs up the tool.

    The tip lies on the axis of the last joint, and so does the shaft.
    """
    to_joint = np.linalg.inv(model.tip.offset)[:3, 3]
    up = to_joint / np.linalg.norm(to_joint)
    x = np.cross(np.eye(3)[np.abs(up).argmin()], up)
    x /= np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(up, x), up])
    return pose


def _moved(pose: np.ndarray, points: np.ndarray) -> np.ndarray:
    return points @ pose[:3, :3].T + pose[:3, 3]
