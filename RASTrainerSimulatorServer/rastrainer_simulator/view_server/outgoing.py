"""What views are told, as the texts of messages; docs/views.md says what each means."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from rastrainer.scenario import Scenario
from rastrainer_simulator.flow.screen import Screen, screen_to_json
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.teleoperation.axes import AxesChoice
from rastrainer_simulator.view_server.messages import PROTOCOL
from rastrainer_simulator.view_server.operator_desk import Control, Feedback
from rastrainer_simulator.view_server.quaternion import quaternion

WELCOME = "welcome"
SCENE = "scene"
STATE = "state"
SCREEN = "screen"
EVENT = "event"
CONTROL = "control"
PAIRING = "pairing"

BODIES = (*(f"link_{joint}" for joint in range(8)), "tool", "head", "stand")
MM_IN_M = 1000.0
# A micrometre, and less than that at the reach of the arm.
DECIMALS = 6


def welcome(view: int) -> str:
    """Return the first message to a view."""
    return _text(WELCOME, protocol=PROTOCOL, view=view, bodies=BODIES)


def scene(sha256: str, scenario: Scenario, task: str, axes: AxesChoice) -> str:
    """Return where the scene is, and what goes with it; `axes` are those of the sticks."""
    cameras = {
        name: {
            "position": (camera.position / MM_IN_M).tolist(),
            "focalPoint": (camera.focal_point / MM_IN_M).tolist(),
            "viewUp": camera.view_up.tolist(),
            "viewAngleDeg": camera.view_angle_deg,
        }
        for name, camera in scenario.cameras.items()
    }
    fiducials = {}
    if task:
        chosen = scenario.task(task)
        points = (chosen.fiducials / MM_IN_M).tolist()
        fiducials = dict(zip(chosen.labels, points, strict=True))
    url = f"/scene/{sha256}.glb"
    return _text(SCENE, url=url, task=task, sticks=axes.value, cameras=cameras, fiducials=fiducials)


def state(now: SimulationState, delayed: int) -> str:
    """Return what moves; `delayed` counts the control loop's late and skipped ticks."""
    training, planned = now.training, now.planned_target
    matrices = (
        *now.link_to_world,
        now.tool_tip_to_world,
        now.head_to_world,
        now.stand_to_world,
    )
    return _text(
        STATE,
        tick=now.tick,
        time=round(now.sim_time, DECIMALS),
        poses=[_pose(matrix) for matrix in matrices],
        clearanceMm=round(now.clearance * MM_IN_M, 3),
        proximity=now.proximity.value,
        camera=now.camera,
        phase=training.phase.value,
        next=training.next_point,
        touched=[touch.label for touch in training.touches],
        elapsed=round(now.elapsed, DECIMALS),
        plannedTarget=None if planned is None else planned.position,
        delayed=delayed,
    )


def screen(now: Screen) -> str:
    """Return what the trainee reads."""
    return _text(SCREEN, screen=screen_to_json(now))


def event(feedback: Feedback) -> str:
    """Return something to be heard and felt."""
    return _text(
        EVENT,
        number=feedback.number,
        kind=feedback.kind,
        sound=feedback.sound,
        volume=feedback.volume,
        rumble=feedback.rumble,
        data=feedback.data,
    )


def control(now: Control, view: int) -> str:
    """Return who drives the arm, as one view is told."""
    return _text(CONTROL, holder=now.holder, isYou=now.view == view)


def pairing(code: str, addresses: Sequence[str]) -> str:
    """Return how another view is paired; for this computer's own views only."""
    return _text(PAIRING, code=code, addresses=addresses)


def _pose(matrix: np.ndarray) -> list[float]:
    rows = matrix.tolist()
    place = (rows[0][3], rows[1][3], rows[2][3])
    return [round(value, DECIMALS) for value in (*place, *quaternion(rows))]


def _text(kind: str, /, **members: Any) -> str:
    message: Mapping[str, Any] = {"type": kind, **members}
    return json.dumps(message, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
