"""The trainee's view of a trial: turned by hand, or led to the next touch; and its inset."""

from __future__ import annotations

import math
from collections.abc import Mapping
from concurrent.futures import Future
from dataclasses import replace

from rastrainer import transforms
from rastrainer.protocol import OPEN_PHASES
from rastrainer.scenario.scenario import Camera, Scenario
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.state import NEUTRAL_STICKS, OperatorInput, SimulationState
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.trial_state import PlannedLine
from rastrainer_simulator.vectors import (
    Vector,
    add,
    any_perpendicular,
    cross,
    length,
    reject,
    scale,
    subtract,
    unit,
)
from rastrainer_simulator.viewpoint.best_view import BestView, BestViews
from rastrainer_simulator.viewpoint.view_control import (
    STILL,
    UP,
    CameraPose,
    Pictures,
    ViewControl,
    camera_pose,
    heading_deg,
    orbit_to,
)


class TrialView:
    """The viewpoint of the pictures of the present trial, and what the sticks mean from there."""

    def __init__(self) -> None:
        self.control = ViewControl()
        # The sticks' right and forward are turned so far from the scenario's camera.
        self.stick_turn_deg = 0.0
        # Where the eyes look, from World's x; None without a headset's controllers.
        self.yaw_deg: float | None = None
        self._best = BestViews()
        self._trial_id = ""
        self._search: tuple[str, Future[BestView | None]] | None = None
        self._found: tuple[str, BestView | None] | None = None
        self._went_for: str | None = None
        # Whether to go to the best view for the arm as it stands now, once it is found.
        self.is_best_wanted = False

    def begin(self, setup: SimulationSetup, state: SimulationState) -> None:
        """Begin to look for the best views of a trial."""
        self.close()
        training = state.training
        self._trial_id = training.trial_id
        if training.is_marked:
            head_to_world = transforms.in_millimeters(state.head_to_world)
            self._best.look(setup, training.task, head_to_world)

    def close(self) -> None:
        self._best.forget()
        self._search = self._found = None
        self._went_for, self.is_best_wanted = None, False

    def has_moved_to(self, label: str | None) -> bool:
        is_there = not self.is_best_wanted and self.control.travel is None
        return label is not None and label == self._went_for and is_there

    def advance(
        self,
        dt: float,
        state: SimulationState,
        scenario: Scenario,
        motion: Vector = STILL,
        sticks: OperatorInput = NEUTRAL_STICKS,
        follows: bool = False,
    ) -> None:
        camera = scenario.cameras[state.camera]
        self.control.use(state.camera)
        label, has_searched = state.training.next_point, False
        # The view of a point is searched when it becomes next, and on request.
        if label is not None and self._is_open(state):
            is_new = self._found is None or self._found[0] != label
            if self._search is None and (self.is_best_wanted or is_new):
                self._search = label, self._best.search(label, state.q)
            elif self._search is not None and self._search[1].done():
                has_searched = self._search[0] == label
                self._found, self._search = (self._search[0], self._search[1].result()), None
        view = self._view_of(state)
        is_wanted = self.is_best_wanted and has_searched
        if view is not None and (is_wanted or (follows and label != self._went_for)):
            self._went_for, self.is_best_wanted = label, False
            orbit = orbit_to(camera, view.eye, view.fiducial)
            self.control.go(orbit, is_automatic=not is_wanted)
        is_still = not any((*sticks.translation, *sticks.rotation))
        self.control.advance(dt, camera, motion, is_still)

    def pictures(self, now: SimulationState, cameras: Mapping[str, Camera]) -> Pictures:
        self.control.use(now.camera)
        main = camera_pose(cameras[now.camera], self.control.orbit)
        procedure, view, inset = now.training.procedure, self._view_of(now), None
        if procedure is not None and procedure.present is not None:
            inset = across_line(main.position, procedure.present.line, now.tip)
        elif view is not None and view.beside is not None:
            inset = along_skin(view.beside, view.fiducial, now.tip)
        return Pictures(main, inset, self.yaw_deg)

    def turned(
        self, sticks: OperatorInput, camera: Camera, axes: AxesChoice, yaw_deg: float | None
    ) -> OperatorInput:
        """Return what the sticks mean to the simulation, whose axes are its own camera's.

        They follow the picture, or eyes that look to `yaw_deg` from World's x. They are turned
        here, before they are recorded: a trial is simulated again as it was.
        """
        self.yaw_deg = yaw_deg
        azimuth_deg = self.control.orbit.azimuth_deg
        self.stick_turn_deg = azimuth_deg if yaw_deg is None else yaw_deg - heading_deg(camera)
        return turned(sticks, self.stick_turn_deg) if axes is AxesChoice.CAMERA else sticks

    def _is_open(self, state: SimulationState) -> bool:
        training = state.training
        is_this = training.trial_id == self._trial_id and training.is_marked
        return is_this and training.phase in OPEN_PHASES

    def _view_of(self, state: SimulationState) -> BestView | None:
        label = state.training.next_point
        is_found = self._found is not None and self._found[0] == label and self._is_open(state)
        return self._found[1] if self._found is not None and is_found else None


def turned(sticks: OperatorInput, turn_deg: float) -> OperatorInput:
    """Return sticks whose right and forward are turned counterclockwise from above.

    Without a turn they stay as they are, bit by bit. The second stick turns the tool as seen
    from behind it, which is right for a tool that points down.
    """
    if turn_deg == 0.0:
        return sticks
    c, s = math.cos(math.radians(turn_deg)), math.sin(math.radians(turn_deg))
    right, forward, up = sticks.translation
    # The corner of a square stick is beyond the round one's end, and turned it would be more than
    # a stick can say.
    long = max(1.0, math.hypot(right, forward, up))
    sideways, ahead = sticks.rotation
    far = max(1.0, math.hypot(sideways, ahead))
    return replace(
        sticks,
        translation=((c * right - s * forward) / long, (s * right + c * forward) / long, up / long),
        rotation=((c * sideways - s * ahead) / far, (s * sideways + c * ahead) / far),
    )


BESIDE_HEIGHT_M = (0.07, 0.3)
"""The least and the greatest height of what the picture along the skin shows."""


def along_skin(eye: Vector, fiducial: Vector, tip: Vector) -> CameraPose:
    """Return the camera that looks along the skin at a fiducial, upright as the main picture.

    It shows the more the farther the tip is, up to a limit; World, m.
    """
    least, most = BESIDE_HEIGHT_M
    height = min(max(2.4 * length(subtract(tip, fiducial)), least), most)
    away = length(subtract(eye, fiducial))
    angle_deg = math.degrees(2.0 * math.atan(0.5 * height / away))
    return CameraPose(eye, fiducial, UP, angle_deg)


AWAY_M = 0.4
MARGIN_M = 0.02
TALLEST_M = 0.34
"""The greatest height of what the picture shows: a tool that is far away is not in it."""


def across_line(eye: Vector, line: PlannedLine, tip: Vector) -> CameraPose:
    """Return the camera that looks across a planned line, from the side of another eye.

    In its picture the instrument comes from above. It shows the whole line, and the tool's tip
    where that is near. World, m.
    """
    middle = scale(add(line.entry, line.target), 0.5)
    across = cross(line.direction, reject(UP, line.direction))
    if length(across) < MARGIN_M:
        across = any_perpendicular(line.direction)
    across = unit(across)
    beside = [add(middle, scale(across, way * AWAY_M)) for way in (1.0, -1.0)]
    nearer = min(beside, key=lambda place: math.dist(place, eye))
    farthest = max(math.dist(middle, end) for end in (line.entry, line.target, tip))
    height = min(2.0 * (farthest + MARGIN_M), TALLEST_M)
    angle_deg = math.degrees(2.0 * math.atan(0.5 * height / AWAY_M))
    return CameraPose(nearer, middle, scale(line.direction, -1.0), angle_deg)
