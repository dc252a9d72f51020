"""The two pictures of the scene: positions that rays from their cameras reach."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from rastrainer.head.mesh import HeadMesh, outward_normals, read_head_mesh
from rastrainer.scenario.points import Task
from rastrainer.transforms import MM_PER_M, apply
from rastrainer_simulator.collision.clearance import LineOfSight
from rastrainer_simulator.collision.collision import head_collision
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.scene.skin_marks import Skin, place_marks
from rastrainer_simulator.state import SimulationState, TouchStage
from rastrainer_simulator.teleoperation.steering import camera_axes
from rastrainer_simulator.vectors import Vector, vector
from rastrainer_simulator.viewpoint.view_control import CameraPose, Pictures, camera_pose

WIDTH_PX, HEIGHT_PX = 1280, 720
INSET_PX = 158
"""Height of the second picture: 22 % of the window's."""
NOISE_PX = 1.0
"""Standard deviation of where something is seen, along each side of the picture."""
COVERED = ((0.77, 0.0, 1.0, 0.27), (0.05, 0.86, 0.95, 1.0), (0.3, 0.0, 0.7, 0.11))
"""The covered parts of the main picture: the inset, the hints and the instruction; shares of its
width and height from the upper left corner: left, top, right, bottom."""
OFF_SKIN_M = 0.002
"""Rays end so far above the marks on the skin."""
BEHIND_TIP_M = 0.004
"""The middle of the tip's colored marker."""
END_ON_DEG = 15.0
"""Seen more along the tool than this, its holder hides the tip."""


@dataclass(frozen=True)
class Picture:
    """What one picture shows.

    Attributes:
        axes: (3, 3) float, rows: right, up and ahead in World, as the room behind shows them.
        pixel_m: size of a pixel at the object in view, from the drawn size of the marks.
        spots: where things are seen, in m right and up of the picture's middle, at that distance:
            "fiducial", "number", "tip", and "head", the middle of its outline.
    """

    axes: np.ndarray
    pixel_m: float
    spots: Mapping[str, np.ndarray]

    @property
    def level_axes(self) -> np.ndarray:
        """The sticks' axes, (3, 3) float, rows: right, level ahead and up."""
        axes = camera_axes(_vector(self.axes[2]), _vector(self.axes[1]))
        return np.array([axes.right, axes.forward, axes.up])


@dataclass(frozen=True)
class Look:
    """One look at the window.

    Attributes:
        main: the main picture.
        beside: the small picture.
        is_still: whether both cameras stand where they stood at the last look.
        outward: from the skin at the fiducial, (3,) float, where the small picture looks along it:
            there its edge is seen.
        stage: what the colors of tip, ring and frame say; None if the tip is hidden.
    """

    main: Picture
    beside: Picture
    is_still: bool
    outward: np.ndarray | None
    stage: TouchStage | None


@dataclass
class _Places:
    """Where a task's marks and the head are in the present pose of the head: World, m."""

    fiducials: dict[str, Vector] = field(default_factory=dict)
    numbers: dict[str, Vector] = field(default_factory=dict)
    outward: dict[str, np.ndarray] = field(default_factory=dict)
    outline: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))


class DrawnPictures:
    """Looks at the pictures that views draw; with its own collision shapes.

    Args:
        setup: what the simulation is made from.
        seed: of the noise.
    """

    def __init__(self, setup: SimulationSetup, seed: int) -> None:
        self._setup = setup
        self._head: HeadMesh = read_head_mesh(setup.scenario.head)
        self._collision = head_collision(setup.shape, self._head, setup.scenario)
        self._kinematics = make_kinematics(setup.robot)
        self._random = np.random.default_rng(seed)
        self._marks: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
        self._places = _Places()
        self._last: tuple[CameraPose, CameraPose] | None = None

    def use(self, task: Task, head_to_world: np.ndarray) -> None:
        """Put the head where a trial has it, with a task's marks on it; (4, 4) float, m."""
        if task.name not in self._marks:
            outward = outward_normals(self._head, task.fiducials)
            lift = MM_PER_M * OFF_SKIN_M * outward
            marks = place_marks(Skin(self._head), task.fiducials, task.labels)
            places = task.fiducials + lift, np.array(marks.places) + lift
            self._marks[task.name] = (*places, outward)
        self._collision.set_head_pose(head_to_world)
        *marks, outward = self._marks[task.name]
        fiducials, numbers = (apply(head_to_world, places / MM_PER_M) for places in marks)
        self._places = _Places(
            dict(zip(task.labels, map(_vector, fiducials), strict=True)),
            dict(zip(task.labels, map(_vector, numbers), strict=True)),
            dict(zip(task.labels, outward @ head_to_world[:3, :3].T, strict=True)),
            apply(head_to_world, self._head.vertices[::50] / MM_PER_M),
        )

    def look(self, state: SimulationState, pictures: Pictures, label: str) -> Look:
        """Return the pictures of a state, in which the next fiducial is marked."""
        beside = pictures.inset
        if beside is None:
            cameras = self._setup.scenario.cameras
            beside = camera_pose(next(c for name, c in cameras.items() if name != state.camera))
        sight = self._collision.line_of_sight(self._kinematics.links(state.q))
        tool = state.tool_tip_to_world
        seen = [
            self._picture(camera, sight, tool, label, height_px, covered)
            for camera, height_px, covered in (
                (pictures.main, HEIGHT_PX, COVERED),
                (beside, INSET_PX, ()),
            )
        ]
        is_still = self._last == (pictures.main, beside)
        self._last = pictures.main, beside
        is_tip_seen = any("tip" in picture.spots for picture in seen)
        outward = None if pictures.inset is None else self._places.outward[label]
        return Look(*seen, is_still, outward, state.touch if is_tip_seen else None)

    def _picture(
        self,
        camera: CameraPose,
        sight: LineOfSight,
        tool: np.ndarray,
        label: str,
        height_px: int,
        covered: Sequence[tuple[float, float, float, float]],
    ) -> Picture:
        eye, middle = np.array(camera.position), np.array(camera.focal_point)
        ahead = (middle - eye) / np.linalg.norm(middle - eye)
        right = np.cross(ahead, camera.view_up)
        right /= np.linalg.norm(right)
        axes = np.array([right, np.cross(right, ahead), ahead])
        half = math.tan(math.radians(camera.view_angle_deg) / 2.0)
        away = float(np.linalg.norm(middle - eye))
        tip, direction = tool[:3, 3], tool[:3, 2]
        marker = _vector(tip - BEHIND_TIP_M * direction)
        fiducial, number = self._places.fiducials[label], self._places.numbers[label]
        to_tip = (tip - eye) / np.linalg.norm(tip - eye)
        is_end_on = to_tip @ direction > math.cos(math.radians(END_ON_DEG))
        reached = {
            "fiducial": sight.is_free(camera.position, fiducial)
            and bool(sight.off_tool(np.array([camera.position]), np.array(fiducial))[0] > 0.0),
            "number": sight.is_free(camera.position, number)
            and bool(sight.off_tool(np.array([camera.position]), np.array(number))[0] > 0.0),
            "tip": sight.is_free(camera.position, marker) and not is_end_on,
        }
        on_skin = np.array(fiducial) - OFF_SKIN_M * self._places.outward[label]
        places = {"fiducial": on_skin, "number": number, "tip": tip}
        spots = {}
        for name, place in places.items():
            spot = self._spot(axes @ (place - eye), half, height_px, covered)
            if reached[name] and spot is not None:
                spots[name] = away * spot
        outline = (self._places.outline - eye) @ axes.T
        shares = outline[:, :2] / outline[:, 2:]
        spots["head"] = away * (shares.min(axis=0) + shares.max(axis=0)) / 2.0
        return Picture(axes, 2.0 * half * away / height_px, spots)

    def _spot(
        self,
        place: np.ndarray,
        half: float,
        height_px: int,
        covered: Sequence[tuple[float, float, float, float]],
    ) -> np.ndarray | None:
        """Return where a position (3,) before a camera is seen, (2,) float, as tangents.

        `half` is that of half the picture's height; None out of the picture.
        """
        if place[2] <= 0.0:
            return None
        spot = place[:2] / place[2]
        spot += self._random.normal(0.0, NOISE_PX * 2.0 * half / height_px, 2)
        across = 0.5 + spot[0] / (2.0 * half) * HEIGHT_PX / WIDTH_PX
        down = 0.5 - spot[1] / (2.0 * half)
        is_inside = 0.0 < across < 1.0 and 0.0 < down < 1.0
        is_covered = any(
            left < across < right and top < down < bottom for left, top, right, bottom in covered
        )
        return spot if is_inside and not is_covered else None


def _vector(array: np.ndarray) -> Vector:
    return vector(array.tolist())
