"""The robot as collisions see it: capsules about its links, and a tapered row along its tool."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.transforms import apply, rigid
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import RobotModel, read_prepared
from rastrainer_simulator.vectors import Vector

if TYPE_CHECKING:
    from rastrainer_simulator.robot.meshes import ColoredMesh

_LONG = 1.35  # A solid longer than this times its width gets a capsule for each half.
_FIRST_STEP, _LAST_STEP = 0.02, 0.0003
_MAX_POINTS = 5_000_000


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` (m) of the segment from `start` to `end`, (3,) float each, m."""

    start: np.ndarray
    end: np.ndarray
    radius: float


def surface_points(vertices: np.ndarray, triangles: np.ndarray, spacing: float) -> np.ndarray:
    """Return points (k, 3) along the edges of a mesh, no two neighbors farther than `spacing`.

    `vertices` is (n, 3) float, `triangles` (m, 3) int.
    """
    start, end = vertices[HeadMesh(vertices, triangles).edges.T]
    counts = np.ceil(np.linalg.norm(end - start, axis=1) / spacing).astype(int) + 1
    if counts.sum() > _MAX_POINTS:
        raise InputError(
            f"A collision mesh has {len(start)} edges of {counts.sum() * spacing:.0f} m in total; "
            "it should be a coarse hull of its link."
        )
    rows = np.repeat(np.arange(len(start)), counts)
    steps = np.arange(len(rows)) - np.repeat(np.cumsum(counts) - counts, counts)
    shares = steps / np.maximum(counts[rows] - 1, 1)
    return start[rows] + shares[:, None] * (end[rows] - start[rows])


def covering_capsules(points: np.ndarray, spacing: float) -> tuple[Capsule, ...]:
    """Return one capsule, or two for a long solid, that hold all `points` (k, 3) float, m.

    `points` are `surface_points` of that `spacing`: then the whole solid's surface is covered.
    """
    middle = points.mean(axis=0)
    axes = np.linalg.eigh(np.cov((points - middle).T)).eigenvectors
    along = (points - middle) @ axes
    length, width = np.ptp(along[:, 2]), np.ptp(along[:, 1])
    if length <= _LONG * width:
        return (_fit(points, axes.T),)
    cut = along[:, 2].min() + length / 2.0
    # Both halves reach over the cut, so that a triangle across it is completely inside them.
    halves = (along[:, 2] <= cut + spacing, along[:, 2] >= cut - spacing)
    return tuple(_fit(points[half], axes.T) for half in halves)


def _fit(points: np.ndarray, directions: np.ndarray) -> Capsule:
    """Return a capsule of little volume about the points, found by pattern search.

    The search starts along each of the `directions` (3, 3) and moves the ends of the axis.
    """
    outermost = points[np.unique((points @ sphere_directions().T).argmax(axis=0))]
    found = []
    for direction in directions:
        along = outermost @ direction
        center = (outermost.min(axis=0) + outermost.max(axis=0)) / 2.0
        reach = direction * np.ptp(along) / 5.0
        ends = np.concatenate([center - reach, center + reach])
        found.append(_pattern_search(outermost, ends))
    _, best = min(found, key=lambda each: each[0])
    start, end = best[:3], best[3:]
    axis = end - start
    shares = ((points - start) @ axis / max(axis @ axis, 1e-12)).clip(0.0, 1.0)
    return Capsule(
        start, end, float(np.linalg.norm(points - start - shares[:, None] * axis, axis=1).max())
    )


def _pattern_search(points: np.ndarray, ends: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the volume and the ends (6,) of the smallest capsule that small moves lead to."""
    volume, step = float(_volumes(points, ends[None])[0]), _FIRST_STEP
    moves = np.concatenate([np.eye(6), -np.eye(6)])
    while step > _LAST_STEP:
        trials = ends + step * moves
        volumes = _volumes(points, trials)
        best = int(volumes.argmin())
        if volumes[best] < volume:
            volume, ends = float(volumes[best]), trials[best]
        else:
            step /= 2.0
    return volume, ends


def _volumes(points: np.ndarray, ends: np.ndarray) -> np.ndarray:
    """Return the volumes of the capsules with the axes `ends` (t, 6) that hold all points."""
    start, axis = ends[:, :3], ends[:, 3:] - ends[:, :3]
    sizes = np.einsum("ti,ti->t", axis, axis)
    offsets = points - start[:, None]
    shares = np.einsum("tki,ti->tk", offsets, axis) / np.maximum(sizes, 1e-12)[:, None]
    offsets -= shares.clip(0.0, 1.0)[:, :, None] * axis[:, None]
    squares = np.einsum("tki,tki->tk", offsets, offsets).max(axis=1)
    return math.pi * squares * (np.sqrt(sizes) + 4.0 / 3.0 * np.sqrt(squares))


def sphere_directions(count: int = 200) -> np.ndarray:
    """Return `count` unit vectors spread evenly over the sphere (a Fibonacci spiral)."""
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * index
    width = np.sqrt(1.0 - z * z)
    return np.column_stack([width * np.cos(turn), width * np.sin(turn), z])


SHAFT_START = 0.003
"""Distance behind the tip, m, from which the tool is a shaft that must not touch the head."""

_LINK_SPACING = 0.01
_TOOL_SPACING = 0.0005
_DECIMALS = 9


@dataclass(frozen=True)
class LinkShape:
    """One link: its capsules in its own frame; `joint` is the number of joints before it."""

    name: str
    joint: int
    capsules: tuple[Capsule, ...]


@dataclass(frozen=True)
class RobotShape:
    """The arm's links, and the tool without its last 3 mm, its capsules in its tip's frame."""

    links: tuple[LinkShape, ...]
    tool: LinkShape
    tip_name: str


def load_shape(model: RobotModel) -> RobotShape:
    """Return the prepared shape of the robot, computed anew where its meshes are replaced."""
    if any(part.replaced for part in model.meshes):
        return robot_shape(model)
    prepared = read_prepared()["shape"]
    tool, *links = (
        LinkShape(
            body["name"],
            body["joint"],
            tuple(
                Capsule(np.array(each["start"]), np.array(each["end"]), each["radius"])
                for each in body["capsules"]
            ),
        )
        for body in (prepared["tool"], *prepared["links"])
    )
    return RobotShape(tuple(links), tool, prepared["tip_name"])


def robot_shape(model: RobotModel) -> RobotShape:
    """Return the capsules that cover the collision meshes of a robot.

    The tool is the outermost link with a mesh. Any other link without a collision mesh collides
    with nothing, as in any URDF.
    """
    meshes = load_meshes(model, "collision")
    *links, tool = (link for link in model.links if link.name in meshes)
    shapes = []
    for link in links:
        capsules = covering_capsules(_points(meshes[link.name], _LINK_SPACING), _LINK_SPACING)
        shapes.append(LinkShape(link.name, link.joint, _rounded(capsules)))
    # A frame in the tip's frame, whose z runs up the tool.
    up = np.array([[0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    shaft_to_tip = rigid(up, np.zeros(3))
    tool_to_shaft = np.linalg.inv(model.tip.offset @ shaft_to_tip) @ tool.offset
    points = apply(tool_to_shaft, _points(meshes[tool.name], _TOOL_SPACING))
    moved = []
    for capsule in capsules_along(points, SHAFT_START):
        start, end = apply(shaft_to_tip, np.array([capsule.start, capsule.end]))
        moved.append(Capsule(start, end, capsule.radius))
    tool_shape = LinkShape(tool.name, tool.joint, _rounded(tuple(moved)))
    return RobotShape(tuple(shapes), tool_shape, model.tip.name)


def _rounded(capsules: tuple[Capsule, ...]) -> tuple[Capsule, ...]:
    """Return the capsules in whole nanometers, the same on every machine, without -0.0."""
    return tuple(
        Capsule(
            capsule.start.round(_DECIMALS) + 0.0,
            capsule.end.round(_DECIMALS) + 0.0,
            round(capsule.radius, _DECIMALS),
        )
        for capsule in capsules
    )


def _points(parts: list[ColoredMesh], spacing: float) -> np.ndarray:
    return np.concatenate(
        [
            surface_points(np.asarray(mesh.vertices), np.asarray(mesh.faces), spacing)
            for mesh, _color in parts
        ]
    )


_SLICE = 0.0005


def capsules_along(points: np.ndarray, start: float, count: int = 5) -> tuple[Capsule, ...]:
    """Return a row of capsules about the z axis that hold all `points` (k, 3) float with z ≥ start.

    The tool's tip is at the origin. The tool is cut into `count` pieces such that they look
    slenderest from there, so that a taper stays a taper. `points` are
    `surface_points` spaced by at most half a millimeter.
    """
    if points[:, 2].max() < start:
        raise InputError("The tool's collision mesh should reach from its tip toward the wrist.")
    slices = np.floor((points[:, 2] - start) / _SLICE).astype(int)
    kept = slices >= 0
    radii = np.zeros(slices.max() + 1)
    np.maximum.at(radii, slices[kept], np.hypot(points[kept, 0], points[kept, 1]))
    # A point on the border of two slices belongs to both.
    profile = np.maximum(radii, np.concatenate([radii[1:], [0.0]]))
    cuts = _slenderest_cuts(profile, start, min(count, len(profile)))
    capsules = []
    for begin, end in pairwise(cuts):
        # The round ends stick out only as needed.
        radii, low = profile[begin:end], start + begin * _SLICE + np.arange(end - begin) * _SLICE
        radius = float(radii.max())
        rounding = np.sqrt(radius**2 - radii**2)
        first = float((low + rounding).min())
        last = max(float((low + _SLICE - rounding).max()), first)
        ends = np.array([0.0, 0.0, first]), np.array([0.0, 0.0, last])
        capsules.append(Capsule(*ends, radius))
    return tuple(capsules)


def _slenderest_cuts(profile: np.ndarray, start: float, count: int) -> list[int]:
    """Return where to cut (count + 1 slices) for the least sum of radius² / z² over all slices.

    Dynamic programming: the best cuts before a slice, for each number of pieces so far.
    """
    size = len(profile)
    weights = np.cumsum(1.0 / (start + np.arange(size + 1) * _SLICE) ** 2)
    least = np.full((count + 1, size + 1), np.inf)
    least[0, 0] = 0.0
    before = np.zeros((count + 1, size + 1), dtype=int)
    for end in range(1, size + 1):
        radii = np.maximum.accumulate(profile[:end][::-1])[::-1]
        totals = least[:-1, :end] + radii**2 * (weights[end] - weights[:end])
        before[1:, end] = totals.argmin(axis=1)
        least[1:, end] = totals.min(axis=1)
    cuts = [size]
    for pieces in range(count, 0, -1):
        cuts.append(int(before[pieces, cuts[-1]]))
    return cuts[::-1]


class PosedArm(NamedTuple):
    """The arm's n capsules in World, m, in the rows of `ArmCapsules`."""

    poses: np.ndarray  # (links + 1, 4, 4) float: LinkToWorld of each link, ToolTipToWorld last
    ends: np.ndarray  # (n, 2, 3) float: start and end of each axis
    tip: Vector

    @property
    def middles(self) -> np.ndarray:
        """Return the middle of each axis, (n, 3) float."""
        return (self.ends[:, 0] + self.ends[:, 1]) / 2.0


class ArmCapsules:
    """The capsules of a robot in one row: the links' capsules from the base on, then the tool's."""

    def __init__(self, shape: RobotShape) -> None:
        bodies = (*shape.links, shape.tool)
        rows = [(row, capsule) for row, body in enumerate(bodies) for capsule in body.capsules]
        self.capsules = tuple(capsule for _, capsule in rows)
        self.body = np.array([row for row, _ in rows])
        self.names = tuple(bodies[row].name for row in self.body)
        self.joints = np.array([bodies[row].joint for row in self.body])
        self.radii = np.array([capsule.radius for capsule in self.capsules])
        self.link_count = len(rows) - len(shape.tool.capsules)
        """How many of the capsules belong to links; the rest are the tool's."""
        starts = np.array([capsule.start for capsule in self.capsules])
        ends = np.array([capsule.end for capsule in self.capsules])
        self.reach = np.linalg.norm(ends - starts, axis=1) / 2.0 + self.radii
        """(n,) float: radius of the sphere about each capsule, m."""
        self._frames = (*(link.name for link in shape.links), shape.tip_name)
        # One product with all poses, their columns one below the other, gives all ends.
        columns = np.zeros((len(rows), 2, len(self._frames), 4))
        for end, points in enumerate((starts, ends)):
            columns[range(len(rows)), end, self.body, :3] = points
            columns[range(len(rows)), end, self.body, 3] = 1.0
        self._ends = columns.reshape(2 * len(rows), -1)

    def pose(self, link_to_world: Mapping[str, np.ndarray]) -> PosedArm:
        """Return the capsules in World; `link_to_world` holds (4, 4) float by link, the tip too."""
        poses = np.array([link_to_world[name] for name in self._frames])
        columns = poses[:, :3].swapaxes(1, 2).reshape(-1, 3)
        ends = (self._ends @ columns).reshape(-1, 2, 3)
        return PosedArm(poses, ends, tuple(poses[-1, :3, 3].tolist()))
