"""What the simulator has sent: a scene's parts and cameras, and what it has said last."""

from __future__ import annotations

import asyncio
import contextlib
import io
import logging
from collections import deque
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

import numpy as np
import trimesh

from rastrainer.errors import InputError
from rastrainer_simulator.desktop.head_marks import ShownTrace
from rastrainer_simulator.desktop.panels.canvas import Thumbnail
from rastrainer_simulator.presentation.messages import StateNews, read_news
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.viewpoint.view_control import CameraPose

UNREADABLE = "The scene that the simulator sent cannot be read: {reason}."


@dataclass(frozen=True)
class Finish:
    """How a surface looks: linear colors 0 to 1 as in glTF, roughness, metallicity, opacity."""

    color: tuple[float, float, float]
    glow: tuple[float, float, float]
    roughness: float
    metallic: float
    opacity: float = 1.0

    @property
    def is_glowing(self) -> bool:
        """Whether it has its own color in any light."""
        return any(self.glow)


@dataclass(frozen=True)
class Part:
    """Triangles of one finish.

    Attributes:
        nodes: names of its node and of those above, the nearest first.
        body: that it moves with; "" for what stands still.
        vertices: (n, 3) float, m, in the body's frame, else in World.
        normals: (n, 3) float, the same.
        triangles: (m, 3) int.
        finish: of all of it.
    """

    nodes: tuple[str, ...]
    body: str
    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    finish: Finish


def read_parts(content: bytes, bodies: Collection[str]) -> list[Part]:
    """Return the parts of a GLB in which the nodes named `bodies` can be moved."""
    try:
        scene = trimesh.load_scene(io.BytesIO(content), file_type="glb", process=False)
        parents = dict(scene.graph.transforms.parents)
    except Exception as error:  # Whatever trimesh trips over in a file that is not what it says.
        raise InputError(UNREADABLE.format(reason=error)) from None
    present = [name for name in bodies if name in parents]
    if not present:
        raise InputError(UNREADABLE.format(reason="the robot is not in it"))
    world = parents[present[0]]
    parts = []
    for name in scene.graph.nodes_geometry:
        ancestry = _ancestry(name, parents)
        body = next((node for node in ancestry if node in bodies), "")
        matrix, geometry = scene.graph.get(name, body or world)
        parts.append(_part(scene.geometry[geometry], matrix, ancestry, body))
    return parts


def _ancestry(name: str, parents: dict[str, str]) -> tuple[str, ...]:
    found = [name]
    while found[-1] in parents:
        found.append(parents[found[-1]])
    return tuple(found)


def _part(mesh: trimesh.Trimesh, matrix: np.ndarray, nodes: tuple[str, ...], body: str) -> Part:
    vertices = mesh.vertices @ matrix[:3, :3].T + matrix[:3, 3]
    normals = mesh.vertex_normals @ matrix[:3, :3].T
    return Part(nodes, body, vertices, normals, np.asarray(mesh.faces), _finish(mesh))


def _finish(mesh: trimesh.Trimesh) -> Finish:
    material = getattr(mesh.visual, "material", None)
    color = getattr(material, "baseColorFactor", None)
    glow = getattr(material, "emissiveFactor", None)
    roughness = getattr(material, "roughnessFactor", None)
    metallic = getattr(material, "metallicFactor", None)
    return Finish(
        (0.6, 0.6, 0.6) if color is None else tuple((np.asarray(color)[:3] / 255.0).tolist()),
        (0.0, 0.0, 0.0) if glow is None else tuple(np.asarray(glow, dtype=float).tolist()),
        0.5 if roughness is None else float(roughness),
        0.0 if metallic is None else float(metallic),
        1.0 if color is None else float(color[3]) / 255.0,
    )


@dataclass(frozen=True)
class Viewpoint:
    """Where a camera stands; World, m; the angle is vertical, degrees.

    `aside` is how far the picture is pushed to the right, in halves of its width.
    """

    position: np.ndarray
    focal_point: np.ndarray
    view_up: np.ndarray
    angle_deg: float
    aside: float = 0.0

    @classmethod
    def of(cls, camera: CameraPose) -> Viewpoint:
        """Return a camera of the stream."""
        position, focal_point = np.array(camera.position), np.array(camera.focal_point)
        return cls(position, focal_point, np.array(camera.view_up), camera.view_angle_deg)

    def toward(self, other: Viewpoint, share: float) -> Viewpoint:
        """Return a viewpoint between this and another; a share of 0 is this one, 1 the other."""
        pairs = (
            (self.position, other.position),
            (self.focal_point, other.focal_point),
            (self.view_up, other.view_up),
        )
        place, focus, up = (start + share * (end - start) for start, end in pairs)
        angle = self.angle_deg + share * (other.angle_deg - self.angle_deg)
        return Viewpoint(place, focus, up, angle, self.aside + share * (other.aside - self.aside))


_log = logging.getLogger(__name__)


@dataclass(frozen=True)
class LoadedScene:
    """A scene to be shown, its cameras by name, and its fiducials in the head's frame (m).

    `no_go` names the nodes of the no-go structures of each procedure; `task` is whose scene it is.
    """

    parts: list[Part]
    cameras: Mapping[str, Viewpoint]
    fiducials: Mapping[str, tuple[float, float, float]]
    no_go: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    task: str = ""


@dataclass(frozen=True)
class SoundEvent:
    """A sound to be played once."""

    name: str
    volume: float


class Inbox:
    """The latest of everything; only sounds wait for each other.

    Attributes:
        state: the latest one, as of the last `read_state`; None before.
        holder: what drives the arm; "" if nothing does.
        has_control: whether it is this window's keys or mouse.
        pairing: code and addresses by which other views are paired; None while unknown.
        bodies: names in the order of a state's poses.
        thumbnails: pictures of the menus' items by where they come from.
        screen: what the trainee reads; None before the first.
        trace: what was traced over the skin, and where to draw next.
        scene: None until one has been loaded.
        sounds: those not played yet.
        problem: key of the text that says why there is no connection; "" while there is one.
    """

    def __init__(self) -> None:
        self.state: StateNews | None = None
        self._unread: str | None = None
        self.screen: Screen | None = None
        self.trace = ShownTrace()
        self.scene: LoadedScene | None = None
        self.sounds: deque[SoundEvent] = deque(maxlen=16)
        self.problem = "window.connecting"
        self.holder = ""
        self.has_control = False
        self.pairing: tuple[str, str] | None = None
        self.bodies: tuple[str, ...] = ()
        self.thumbnails: dict[str, Thumbnail] = {}
        self._has_changed = asyncio.Event()

    def take_state(self, text: str) -> None:
        """Replace the state by a message, which is not parsed until it is drawn.

        So a window that draws slowly still keeps up with what is sent 60 times a second.
        """
        self._unread = text
        self.touch()

    def read_state(self) -> None:
        """Read the latest message; one that is no state changes nothing."""
        text, self._unread = self._unread, None
        if text is None:
            return
        try:
            news = read_news(text)
            if not isinstance(news, StateNews) or len(news.poses) != len(self.bodies):
                raise InputError("It must have a pose for each body.")
            self.state = news
        except InputError as error:
            _log.warning("A state of the simulator cannot be used: %s", error)

    def touch(self) -> None:
        """Wake the thread that waits for messages."""
        self._has_changed.set()

    async def wait(self, timeout: float) -> None:
        """Wait for messages, but at most `timeout` seconds."""
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(self._has_changed.wait(), timeout)
        self._has_changed.clear()
