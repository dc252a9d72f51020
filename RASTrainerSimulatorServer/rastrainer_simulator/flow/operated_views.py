"""The views of a simulator: who operates which, and how the pictures are turned."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.protocol import Mode
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.controls import Controls
from rastrainer_simulator.input.inputs import SIMULATOR_STATION, ControlContext, Source, SourceKind
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.messages import Hello
from rastrainer_simulator.record.trial_context import ViewReport
from rastrainer_simulator.replay.playback import PlaybackSwitch
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.viewpoint.view_control import Pictures, ViewMotion

NOTED_S = 0.2
"""How often a moving view is noted in the journal."""


LONGEST_WAIT_S = 300.0
"""A picture that has made no progress for so long is not waited for: the view may be broken."""


@dataclass
class _LoadedScene:
    task: str
    share: float
    since_s: float = 0.0


class AwaitedPictures:
    """Knows how much each view has drawn; a view that reports nothing counts as ready."""

    def __init__(self) -> None:
        self._loaded: dict[int, _LoadedScene] = {}

    def take(self, view: int, task: str, share: float) -> None:
        self._loaded[view] = _LoadedScene(task, share)

    def forget(self, view: int) -> None:
        self._loaded.pop(view, None)

    def advance(self, dt: float, view: int | None, task: str) -> float | None:
        """Return what a view has loaded, 0 to 1, while its picture of a task is to be awaited."""
        loaded = None if view is None else self._loaded.get(view)
        if loaded is None or (loaded.task, loaded.share) == (task, 1.0):
            return None
        loaded.since_s += dt
        if loaded.since_s > LONGEST_WAIT_S:
            return None
        return loaded.share if loaded.task == task else 0.0


class ViewSources:
    """Knows each view by its number, from when it joins until it leaves."""

    def __init__(self) -> None:
        self._views: dict[int, Hello] = {}
        self._silent: set[int] = set()
        self._touched: set[int] = set()
        self._yaw_deg: dict[int, float] = {}

    def join(self, view: int, hello: Hello) -> None:
        self._views[view] = hello

    def leave(self, view: int) -> Hello | None:
        """Forget a view and return it; None if it is unknown."""
        self._silent.discard(view)
        self._touched.discard(view)
        self._yaw_deg.pop(view, None)
        return self._views.pop(view, None)

    def hello(self, view: int) -> Hello | None:
        return self._views.get(view)

    @property
    def is_empty(self) -> bool:
        return not self._views

    @property
    def has_headset(self) -> bool:
        return any(hello.kind == "headset" for hello in self._views.values())

    def hear(self, view: int, is_heard: bool) -> None:
        """Note whether a view reports that it draws."""
        if is_heard:
            self._silent.discard(view)
        else:
            self._silent.add(view)

    def look(self, view: int, yaw_deg: float) -> None:
        """Note where the eyes of a headset look, degrees from World's x."""
        self._yaw_deg[view] = yaw_deg

    def yaw_deg(self, holder: Source | None) -> float | None:
        """Return where the eyes above an operator's controllers look; None without those."""
        if holder is None or holder.kind is not SourceKind.XR or holder.view is None:
            return None
        return self._yaw_deg.get(holder.view)

    def watched(self, holder: Source | None) -> int | None:
        """Return the view that the trainee looks at: a headset, else the operated view."""
        # A headset whose network broke comes back as another view, long before the first has left.
        heard = [each for each in reversed(self._views.items()) if each[0] not in self._silent]
        by_kind = {hello.kind: view for view, hello in heard}
        operated = None if holder is None else holder.view
        choices = (by_kind.get("headset"), operated, by_kind.get("desktop"), by_kind.get("page"))
        return next((view for view in choices if view is not None), None)

    def source(self, kind: SourceKind, view: int) -> Source:
        hello = self._views.get(view)
        is_own = hello is not None and hello.kind == "desktop"
        return Source(kind, SIMULATOR_STATION if is_own else f"view {view}", view)

    def sticks_source(self, view: int, has_screen_sticks: bool) -> Source:
        """Return whose sticks a view sends: a headset's, a touch screen's, or a mouse's.

        A page has its own sticks on a touch screen; for a mouse they have been asked for.
        """
        hello = self._views.get(view)
        if hello is None or hello.kind == "headset":
            return self.source(SourceKind.XR, view)
        is_for_mouse = has_screen_sticks and view not in self._touched
        if hello.kind == "desktop" or is_for_mouse:
            return self.source(SourceKind.MOUSE, view)
        self._touched.add(view)
        return self.source(SourceKind.TOUCH_SCREEN, view)

    def hand_source(self, kind: SourceKind, view: int) -> Source:
        """Return what an item was chosen or written with: a finger, where one has been seen."""
        hello = self._views.get(view)
        if hello is not None and hello.kind == "headset":
            return self.source(SourceKind.XR, view)
        return self.source(SourceKind.TOUCH_SCREEN if view in self._touched else kind, view)


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
        return self._session.view.pictures(now, self._shown.setup.scenario.cameras)

    def turn(self, source: Source, around_deg: float, higher_deg: float, zoom: float) -> None:
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
            # In a headset the trainee looks around by turning the head.
            return False
        if tutorial is not None and not tutorial.has_learned_view:
            return False
        choice = session.preferences.view
        is_led = session.services.assigned.steps.get(practiced.trainee) is not None
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
            round(orbit.azimuth_deg, 2),
            round(orbit.elevation_deg, 2),
            round(orbit.zoom, 2),
            control.is_automatic,
            self.follows,
        )
        if self._noted != (session.training.trial_id, report):
            self._noted, self._since_noted = (session.training.trial_id, report), 0.0
            self._control_loop.note_display(report)
