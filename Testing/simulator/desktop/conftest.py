"""A window without a display, and a small scene of which every color is known."""

from __future__ import annotations

import json

import numpy as np
import pytest
import trimesh

from rastrainer.json_records import record_from_json
from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene, Viewpoint, read_parts
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.viewports import Quality
from rastrainer_simulator.presentation.screen import (
    Hint,
    ItemKind,
    Menu,
    MenuItem,
    Screen,
    ScreenMessage,
    Tone,
)
from rastrainer_simulator.scene.nodes import ARROW, SKIN, STEEL, TIP_FREE, WAITING, WALL, Node
from rastrainer_simulator.scene.scene_glb import to_glb
from rastrainer_simulator.scene.surfaces import shaded
from rastrainer_simulator.viewpoint.view_control import CameraPose

SIZE = (960, 540)
BODIES = ("link_7", "tool", "head")
HERE = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
ASIDE = (5.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
"""Where the last link is out of every picture."""
FIDUCIALS = {"1": (-0.06, -0.09, 0.0), "2": (0.0, -0.1, 0.0), "3": (0.06, -0.09, 0.0)}
CAMERA = {
    "position": [0.0, -0.8, 0.0],
    "focalPoint": [0.0, 0.0, 0.0],
    "viewUp": [0.0, 0.0, 1.0],
    "viewAngleDeg": 30.0,
}
FAR = {**CAMERA, "position": [0.0, -2.4, 0.0]}
CAMERAS = {"close-up": CAMERA, "far": FAR}
VIEWPOINTS = {
    name: Viewpoint.of(record_from_json(CameraPose, value, "The camera"))
    for name, value in CAMERAS.items()
}


def ball(name, radius, center, material, children=()):
    sphere = trimesh.creation.icosphere(subdivisions=2, radius=radius)
    vertices = sphere.vertices + np.asarray(center)
    return Node(name, (shaded(vertices, sphere.faces, material, 80.0),), children)


def make_glb() -> bytes:
    """A head with three fiducials and an arrow, a tool whose tip is its origin, and a wall."""
    marks = [ball(f"fiducial_{name}", 0.012, place, WAITING) for name, place in FIDUCIALS.items()]
    skin = ball("skin", 0.1, (0, 0, 0), SKIN)
    arrow = ball("arrow_1", 0.005, (-0.03, -0.1, 0.0), ARROW)
    head = Node("head", children=(skin, *marks, arrow))
    tool = Node("tool", children=(ball("tip_marker", 0.01, (0, 0, 0.01), TIP_FREE),))
    wall = trimesh.creation.box(bounds=[[-3, 0.5, -3], [3, 0.6, 3]])
    room = Node("room", (shaded(wall.vertices, wall.faces, WALL),))
    link = ball("link_7", 0.03, (0, 0, 0), STEEL)
    return to_glb([link, tool, head, room])


def state_text(**changes):
    """Return a state message, with the tool in front of the forehead."""
    poses = {"tool": (0.0, -0.15, 0.05, 0.0, 0.0, 0.0, 1.0), "head": HERE}
    members = {
        "type": "state",
        "tick": 1,
        "timeS": 0.0,
        "proximity": "free",
        "elapsedS": 0.0,
        "plannedTarget": None,
        "delayed": 0,
        "poses": poses,
        "ghost": None,
        "touch": "far",
        "clearanceMm": 50.0,
        "camera": "close-up",
        "view": CAMERAS[changes.get("camera", "close-up")],
        "inset": None,
        "translucent": {"view": [], "inset": []},
        "phase": "running",
        "next": "2",
        "touched": ["1"],
        "procedure": None,
        **changes,
    }
    members["poses"] = [members["poses"].get(body, ASIDE) for body in BODIES]
    return json.dumps(members, separators=(",", ":"))


MENU = Menu(
    "experiment",
    "Experiment",
    ("A paragraph that tells the trainee what there is to be chosen, and why.",),
    items=(
        MenuItem(
            "trainee", "Your ID", ItemKind.TEXT, "P07", help="Your instructor gives you this."
        ),
        MenuItem("mode", "Mode", ItemKind.CHOICE, "Desktop"),
        MenuItem("axis", "Left stick", ItemKind.AXIS, "0.5"),
        MenuItem("task-1", "Task 1", value="done"),
        MenuItem("task-2", "Task 2", is_enabled=False, help="Task 1 comes first."),
    ),
    focus="mode",
)
SCREEN = Screen(
    instruction=ScreenMessage("P07, touch point 2.", Tone.GOOD),
    status=("Task 1", "1 of 3", "00:12"),
    hints=(Hint("A", "Touch"), Hint("B", "Undo")),
    has_arrow=True,
)


@pytest.fixture(scope="session")
def glb() -> bytes:
    return make_glb()


@pytest.fixture(scope="module")
def gl_window():
    from rastrainer_simulator.desktop.gl_window import GlWindow

    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SDL_VIDEODRIVER", "offscreen")
        window = GlWindow(SIZE, is_fullscreen=False)
        yield window
        window.close()


@pytest.fixture(scope="module")
def inbox(glb):
    """What a window of that scene has received."""
    inbox = Inbox()
    inbox.bodies = BODIES
    inbox.scene = LoadedScene(read_parts(glb, BODIES), VIEWPOINTS, FIDUCIALS)
    return inbox


@pytest.fixture(scope="module")
def picture(gl_window, inbox):
    """A picture of it, as software OpenGL draws it."""
    picture = Picture(gl_window, inbox, Quality.LOW)
    yield picture
    for renderer in list(gl_window.render_window.GetRenderers()):
        gl_window.render_window.RemoveRenderer(renderer)
