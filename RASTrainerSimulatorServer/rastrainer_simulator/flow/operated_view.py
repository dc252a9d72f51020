"""The operator's hands on the view: what they turn, what the sticks mean by it, what is noted."""

from __future__ import annotations

from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.flow.session.trial_view import turned
from rastrainer_simulator.input.control_name import ControlContext
from rastrainer_simulator.input.controls import Controls
from rastrainer_simulator.input.inputs import Source, SourceKind
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.operator_input import OperatorInput
from rastrainer_simulator.record.beside_the_trial import ViewReport
from rastrainer_simulator.replay.playback import PlaybackSwitch
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.teleoperation.axes import AxesChoice
from rastrainer_simulator.viewpoint.view_control import Pictures, ViewMotion

NOTED_S = 0.2
"""A view that moves is noted in the journal so often."""


class OperatedView:
    """The session's view between controls, control loop and views."""

    def __init__(
        self,
        session: TrainingSession,
        controls: Controls,
        control_loop: ControlLoop,
        shown: PlaybackSwitch,
    ) -> None:
        self._session = session
        self._controls = controls
        self._control_loop = control_loop
        self._shown = shown
        self._yaw_deg: dict[int, float] = {}
        self._noted: tuple[str, ViewReport] | None = None
        self._since_noted = 0.0

    def pictures(self, now: SimulationState) -> Pictures:
        """Return where the pictures of a state are looked from."""
        return self._session.view.pictures(now, self._shown.setup.scenario.cameras)

    def turn(self, source: Source, around_deg: float, higher_deg: float, zoom: float) -> None:
        """Turn the view for the operator; nobody else may."""
        if self._controls.is_operator(source):
            shown = self._shown
            camera = shown.setup.scenario.cameras[shown.latest.camera]
            self._session.view.control.turn(camera, around_deg, higher_deg, zoom)

    def look(self, view: int, yaw_deg: float | None) -> None:
        """Take where the eyes of a headset look, degrees from World's x; None where it has left."""
        self._yaw_deg.pop(view, None)
        if yaw_deg is not None:
            self._yaw_deg[view] = yaw_deg

    def turned(self, sticks: OperatorInput) -> OperatorInput:
        """Return what the sticks mean to the simulation, whose axes are its own camera's.

        They are turned here, before they are recorded: a trial is simulated again as it was.
        """
        view, setup, holder = self._session.view, self._control_loop.setup, self._controls.holder
        yaw_deg = None
        if holder is not None and holder.kind is SourceKind.XR and holder.view is not None:
            yaw_deg = self._yaw_deg.get(holder.view)
        view.look_along(setup.scenario.cameras[self._control_loop.latest.camera], yaw_deg)
        is_followed = setup.settings.axes is AxesChoice.CAMERA
        return turned(sticks, view.stick_turn_deg) if is_followed else sticks

    def advance(self, dt: float) -> None:
        """Move the view by `dt` seconds, and have the trial's journal say where it is."""
        session = self._session
        session.view.advance(
            dt,
            self._shown.latest,
            self._shown.setup.scenario,
            ViewMotion(*self._controls.view),
            self._controls.sticks,
            session.does_view_follow and self._controls.situation is ControlContext.WORK,
        )
        self._since_noted += dt
        if session.has_open_trial and self._since_noted >= NOTED_S:
            self._note()

    def _note(self) -> None:
        session = self._session
        control, orbit = session.view.control, session.view.control.orbit
        report = ViewReport(
            orbit.azimuth_deg,
            orbit.elevation_deg,
            orbit.zoom,
            control.is_automatic,
            session.does_view_follow,
        )
        if self._noted != (session.training.trial_id, report):
            self._noted, self._since_noted = (session.training.trial_id, report), 0.0
            self._control_loop.note_display(report)
