"""The scene as VTK's actors: moved, marked and colored as the simulator's state says."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence
from itertools import chain

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkProp3D, vtkProperty

from rastrainer_simulator.desktop.head_marks import ShownTrace, SkinPaint
from rastrainer_simulator.desktop.inbox import Finish, Part
from rastrainer_simulator.presentation.look import (
    CLEAR_SKIN_OPACITY,
    COVER_OPACITY,
    INSTRUMENTS,
    PULSE_COLOR,
    TOOL_NODES,
)
from rastrainer_simulator.rendering.lighting import AMBIENT, DIFFUSE, glow, lit_colors
from rastrainer_simulator.scene.nodes import (
    COVERED,
    GHOST,
    GHOST_OPACITY,
    NEXT,
    NO_GO_PREFIX,
    TIP_ERROR,
    TIP_FREE,
    TIP_MARKER,
    TIP_NEAR,
    TIP_ON_SKIN,
    TOUCHED,
    WAITING,
)
from rastrainer_simulator.scene.surfaces import surface
from rastrainer_simulator.state import TOUCH_ERRORS, TouchStage
from rastrainer_simulator.trial_state import Tool

Shade = tuple[float, float, float]


def to_srgb(color: Shade) -> Shade:
    """Return a linear color as screens take it (IEC 61966-2-1)."""
    red, green, blue = (
        12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055
        for value in color
    )
    return red, green, blue


def finish_surface(target: vtkProperty, finish: Finish, is_physical: bool) -> None:
    """Set a property: physically based where there is light for that, else plain."""
    if finish.is_glowing:
        glow(target, to_srgb(finish.glow))
    elif is_physical:
        target.SetInterpolationToPBR()
        target.SetColor(*finish.color)
        target.SetAmbient(0.0)
        target.SetDiffuse(1.0)
        target.SetRoughness(finish.roughness)
        target.SetMetallic(finish.metallic)
    else:
        target.SetInterpolationToPhong()
        target.SetColor(*to_srgb(finish.color))
        target.SetAmbient(AMBIENT)
        target.SetDiffuse(DIFFUSE)
        target.SetSpecular(0.28 * (1.0 - finish.roughness))
        target.SetSpecularPower(4.0 + 40.0 * (1.0 - finish.roughness))


FIDUCIAL = "fiducial_"
_TIPS = {
    TouchStage.FAR: TIP_FREE,
    TouchStage.NEAR: TIP_NEAR,
    TouchStage.ON_SKIN: TIP_ON_SKIN,
    TouchStage.PRESSED: TIP_NEAR,
}
OWN_LOOK = frozenset({TIP_MARKER, *chain(*TOOL_NODES.values())})
"""Nodes at the tool that stay as they are where the tool is seen through."""
SKIN_NODE = "skin"
STILL_BODIES = ("", "head", "stand")
"""Do not move during a trial; "" is the room."""


class ShownScene:
    """Actors of one scene.

    Attributes:
        still, moving: its actors, by whether they look the same in most pictures.
        still_version: another number whenever those that stand still look different.
        is_clear: whether what is within the head is seen through the skin.
        poses: (4, 4) float of each body that was placed, to World.
    """

    def __init__(self, parts: Sequence[Part], is_physical: bool):
        self._finishes = {}
        self._matrices: dict[str, vtkMatrix4x4] = defaultdict(vtkMatrix4x4)
        self._named: dict[str, list[vtkActor]] = defaultdict(list)
        self._bodies: dict[str, list[vtkActor]] = defaultdict(list)
        self.still: list[vtkActor] = []
        self.moving: list[vtkProp3D] = []
        self.still_version = 0
        self.is_clear = False
        self.poses: dict[str, np.ndarray] = {}
        self._lit: dict[str, list[tuple[vtkActor, Part]]] = {body: [] for body in STILL_BODIES}
        self._is_physical = is_physical
        self._coverage = SkinPaint()
        self._ghost = _Ghost()
        for part in parts:
            actor = self._actor(part)
            (self.still if _stands_still(part) else self.moving).append(actor)
            if part.body and part.body not in STILL_BODIES:
                self.moving.append(self._ghost.add(part.body, actor))
            self._finishes[actor] = part.finish
            if part.body in STILL_BODIES and not part.finish.is_glowing:
                self._lit[part.body].append((actor, part))
            for name in part.nodes:
                self._named[name].append(actor)
            has_own_look = part.finish.opacity < 1.0 or not OWN_LOOK.isdisjoint(part.nodes)
            if part.body not in STILL_BODIES and not has_own_look:
                self._bodies[part.body].append(actor)
        for name in list(self._named):
            if name in {*INSTRUMENTS, "guide", "axis"} or name.startswith(NO_GO_PREFIX):
                self._set_visible(name, False)
        self._marked: object = None
        self._pulsing: list[vtkActor] = []
        self.finish(is_physical)

    @property
    def actors(self) -> list[vtkProp3D]:
        return [*self.still, *self.moving]

    def finish(self, is_physical: bool) -> None:
        """Make the surfaces physically based, or plain; marks and tip are as in the file again."""
        for actor, finish in self._finishes.items():
            finish_surface(actor.GetProperty(), finish, is_physical)
        self._marked = None
        self._is_physical = is_physical
        for body in STILL_BODIES:
            self._light_still(body)

    def place(self, poses: Mapping[str, Sequence[float]]) -> None:
        """Move bodies; each pose is x, y, z (m) and a quaternion x, y, z, w, in World."""
        for body, pose in poses.items():
            if body not in self._matrices:
                continue
            matrix = pose_matrix(pose)
            is_moved = not np.array_equal(matrix, self.poses.get(body, np.eye(4)))
            self.poses[body] = matrix
            self._matrices[body].DeepCopy(matrix.ravel().tolist())
            if is_moved and body in STILL_BODIES:
                self._light_still(body)

    def place_ghost(self, poses: Mapping[str, Sequence[float]] | None) -> None:
        """Show a ghost of some bodies, their poses as of `place`; None for none."""
        self._ghost.place(poses or {})

    def _light_still(self, body: str) -> None:
        """Compute the plain light of a body that does not move once, not for each pixel.

        In software OpenGL that saves a third of a picture's time.
        """
        self.still_version += 1
        rotation = self.poses.get(body, np.eye(4))[:3, :3]
        for actor, part in self._lit[body]:
            covered = self._coverage.shares if SKIN_NODE in part.nodes else None
            has_colors = covered is not None or not self._is_physical
            actor.GetMapper().SetScalarVisibility(has_colors)
            actor.GetProperty().SetLighting(self._is_physical)
            if not has_colors:
                continue
            # As light where a shader computes with it, else as screens take it.
            of_light = (lambda color: color) if self._is_physical else to_srgb
            colors = np.array(of_light(part.finish.color))
            if covered is not None:
                paint = np.array(of_light(COVERED.linear_color))
                colors = colors + covered[:, None] * (paint - colors)
            if self._is_physical:
                shown = (255.0 * colors + 0.5).astype(np.uint8)
            else:
                shown = lit_colors(part.normals @ rotation.T, colors)
            data = actor.GetMapper().GetInput().GetPointData()
            data.SetScalars(numpy_to_vtk(shown, deep=True))

    def mark(self, next_point: str | None, touched: Collection[str], touch: TouchStage) -> None:
        """Color the tool's tip and the fiducials."""
        tip = TIP_ERROR if touch in TOUCH_ERRORS else _TIPS[touch]
        wanted = (next_point, tuple(touched), tip)
        if wanted == self._marked:
            return
        self._marked = wanted
        self._paint(TIP_MARKER, tip.color)
        done = set(touched)
        for name in list(self._named):
            if name.startswith(FIDUCIAL):
                label = name.removeprefix(FIDUCIAL)
                state = TOUCHED if label in done else NEXT if label == next_point else WAITING
                self._paint(name, state.color)
        self._pulsing = [] if next_point is None else self._named[f"{FIDUCIAL}{next_point}"]

    def show_instrument(self, tool: Tool, feed_m: float, no_go: Collection[str]) -> None:
        """Show what a procedure's tool is, how far it is fed, and its no-go structures by name."""
        shown = TOOL_NODES.get(tool, ())
        for name in {*INSTRUMENTS, "guide", "axis"}:
            self._set_visible(name, name in shown and (name not in INSTRUMENTS or feed_m > 0.0))
        for name in INSTRUMENTS:
            for actor in self._named[name]:
                actor.SetScale(1.0, 1.0, max(feed_m, 1e-6))
        for name in list(self._named):
            if name.startswith(NO_GO_PREFIX):
                self._set_visible(name, bool(shown) and name in no_go)

    def paint_skin(self, trace: ShownTrace) -> None:
        for _actor, part in self._lit["head"]:
            if SKIN_NODE in part.nodes and self._coverage.cover(part.vertices, trace):
                self._light_still("head")

    def clear_head(self, is_clear: bool) -> None:
        """Let what is within the head be seen through the skin, or not."""
        self.is_clear = is_clear
        self.still_version += 1
        for actor in self._named[SKIN_NODE]:
            actor.GetProperty().SetOpacity(CLEAR_SKIN_OPACITY if is_clear else 1.0)

    def see_through(self, bodies: Collection[str]) -> None:
        """Draw these bodies of the arm translucent, and the others not."""
        for body, actors in self._bodies.items():
            for actor in actors:
                actor.GetProperty().SetOpacity(COVER_OPACITY if body in bodies else 1.0)

    def _set_visible(self, name: str, is_visible: bool) -> None:
        for actor in self._named[name]:
            actor.SetVisibility(is_visible)

    def pulse(self, share: float) -> None:
        """Brighten the next fiducial by a share, 0 to 1."""
        color = [
            (1.0 - share) * value + share * bright
            for value, bright in zip(NEXT.color, PULSE_COLOR, strict=True)
        ]
        for actor in self._pulsing:
            actor.GetProperty().SetColor(*color)

    def _paint(self, name: str, color: tuple[float, float, float]) -> None:
        for actor in self._named[name]:
            glow(actor.GetProperty(), color)

    def _actor(self, part: Part) -> vtkActor:
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(surface(part.vertices, part.triangles, part.normals))
        mapper.ScalarVisibilityOff()
        mapper.StaticOn()
        actor = vtkActor()
        actor.SetMapper(mapper)
        # As in the page: three.js draws no triangle from behind either.
        actor.GetProperty().BackfaceCullingOn()
        actor.GetProperty().SetOpacity(part.finish.opacity)
        if part.body:
            actor.SetUserMatrix(self._matrices[part.body])
        return actor


def _stands_still(part: Part) -> bool:
    """Return whether a part neither moves, nor changes its color, nor is seen through."""
    is_mark = any(name.startswith(FIDUCIAL) for name in part.nodes)
    return part.body in STILL_BODIES and not is_mark and part.finish.opacity == 1.0


class _Ghost:
    """Translucent doubles of what moves, hidden until they are placed."""

    def __init__(self) -> None:
        self._actors: dict[str, list[vtkActor]] = defaultdict(list)
        self._matrices: dict[str, vtkMatrix4x4] = defaultdict(vtkMatrix4x4)

    def add(self, body: str, real: vtkActor) -> vtkActor:
        """Return the double of an actor of a body."""
        double = vtkActor()
        double.SetMapper(real.GetMapper())
        double.SetUserMatrix(self._matrices[body])
        double.VisibilityOff()
        target = double.GetProperty()
        target.BackfaceCullingOn()
        target.SetInterpolationToPhong()
        target.SetColor(*GHOST.color)
        target.SetAmbient(AMBIENT)
        target.SetDiffuse(DIFFUSE)
        target.SetOpacity(GHOST_OPACITY)
        self._actors[body].append(double)
        return double

    def place(self, poses: Mapping[str, Sequence[float]]) -> None:
        """Show the bodies that have a pose, and only those."""
        for body, actors in self._actors.items():
            pose = poses.get(body)
            if pose is not None:
                self._matrices[body].DeepCopy(pose_matrix(pose).ravel().tolist())
            for actor in actors:
                actor.SetVisibility(pose is not None)


def pose_matrix(pose: Sequence[float]) -> np.ndarray:
    """Return (4, 4) float of a position and a unit quaternion x, y, z, w."""
    px, py, pz, x, y, z, w = pose
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), px],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), py],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), pz],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
