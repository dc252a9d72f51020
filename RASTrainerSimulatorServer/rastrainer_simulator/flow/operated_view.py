"""The operator's hands on the view: what they turn, when it follows the points, what is noted."""

from __future__ import annotations

from rastrainer.protocol import Mode
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.controls import Controls
from rastrainer_simulator.input.inputs import ControlContext, Source
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.beside_the_trial import ViewReport
from rastrainer_simulator.replay.playback import PlaybackSwitch
from rastrainer_simulator.state import SimulationState
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

    @property
    def follows(self) -> bool:
        """Whether the view goes automatically to the best view of each next point."""
        session, tutorial = self._session, self._session.tutorial
        practiced = session.training if tutorial is None else tutorial
        if practiced.mode == Mode.HMD.value:
            # In a headset one looks around with the head.
            return False
        if tutorial is not None and not tutorial.has_learned_view:
            return False
        choice = session.preferences.view
        is_led = session.study.step_of(practiced.trainee) is not None
        return choice == "always" or (choice == "practice" and not is_led)

    def advance(self, dt: float) -> None:
        """Move the view by `dt` seconds, and have the trial's journal say where it is."""
        session = self._session
        session.view.advance(
            dt,
            self._shown.latest,
            self._shown.setup.scenario,
            ViewMotion(*self._controls.view),
            self._controls.sticks,
            self.follows and self._controls.situation is ControlContext.WORK,
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
            self.follows,
        )
        if self._noted != (session.training.trial_id, report):
            self._noted, self._since_noted = (session.training.trial_id, report), 0.0
            self._control_loop.note_display(report)
