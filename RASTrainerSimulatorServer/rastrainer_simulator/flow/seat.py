"""The seat: its views and what they operate with; what a teacher sees of it, and has done there."""

from __future__ import annotations

from rastrainer.protocol import OPEN_PHASES, PROCEDURE_PHASES, Phase
from rastrainer_simulator.flow.flow import Flow
from rastrainer_simulator.flow.pages.replay import ReplayPage
from rastrainer_simulator.flow.pages.result import ResultPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import SIMULATOR_SEAT, Source, SourceKind
from rastrainer_simulator.net.views.presenter import Hello, InstructorOrder, Seat
from rastrainer_simulator.net.views.screen import Screen, Tone


class ViewSources:
    """Knows each view by its number, from when it joins until it leaves."""

    def __init__(self) -> None:
        self._views: dict[int, Hello] = {}
        self._silent: set[int] = set()
        self._touched: set[int] = set()
        self._yaw_deg: dict[int, float] = {}

    def join(self, view: int, hello: Hello) -> None:
        """Take note of a view."""
        self._views[view] = hello

    def leave(self, view: int) -> Hello | None:
        """Forget a view; return what it was, None where it is not known."""
        self._silent.discard(view)
        self._touched.discard(view)
        self._yaw_deg.pop(view, None)
        return self._views.pop(view, None)

    def hello(self, view: int) -> Hello | None:
        """Return what a view is; None where it is not known."""
        return self._views.get(view)

    @property
    def has_headset(self) -> bool:
        """Whether one of them is a headset."""
        return any(hello.kind == "headset" for hello in self._views.values())

    def hear(self, view: int, is_heard: bool) -> None:
        """Take note whether a view says that it draws."""
        if is_heard:
            self._silent.discard(view)
        else:
            self._silent.add(view)

    def look(self, view: int, yaw_deg: float) -> None:
        """Take where the eyes of a headset look, degrees from World's x."""
        self._yaw_deg[view] = yaw_deg

    def yaw_deg(self, holder: Source | None) -> float | None:
        """Return where the eyes above an operator's controllers look; None without those."""
        if holder is None or holder.kind is not SourceKind.XR or holder.view is None:
            return None
        return self._yaw_deg.get(holder.view)

    def watched(self, holder: Source | None) -> int | None:
        """Return the view that the trainee looks at: a headset, else the one that is operated."""
        # A headset whose network broke comes back as another view, long before the first has left.
        heard = [each for each in reversed(self._views.items()) if each[0] not in self._silent]
        by_kind = {hello.kind: view for view, hello in heard}
        operated = None if holder is None else holder.view
        choices = (by_kind.get("headset"), operated, by_kind.get("desktop"), by_kind.get("page"))
        return next((view for view in choices if view is not None), None)

    def source(self, kind: SourceKind, view: int) -> Source:
        """Return a view's source; the simulator's own windows share a seat with its gamepad."""
        hello = self._views.get(view)
        is_own = hello is not None and hello.kind == "desktop"
        return Source(kind, SIMULATOR_SEAT if is_own else f"view {view}", view)

    def sticks_source(self, view: int, has_screen_sticks: bool) -> Source:
        """Return whose sticks a view sends: a headset's, a touch screen's, or a mouse's.

        A page has sticks of its own on a touch screen; for a mouse they have been asked for.
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


_WRONG = (Tone.WARNING, Tone.ERROR)
SENTENCE_S = 20.0
"""How long the trainee sees a teacher's sentence: longer than a notice, since nobody expects it."""


def seat_of(session: TrainingSession, screen: Screen, holder: str, count: int) -> Seat:
    """Return what a board shows of a seat; `count` is how many points its trial has."""
    training = session.training
    is_open = training.phase in OPEN_PHASES
    trainee = training.trainee if is_open else session.trainee.strip()
    scores = [trial.score for trial in session.history.of(trainee) if not trial.is_aborted]
    return Seat(
        trainee=trainee,
        task=session.task_title(training.task) if is_open else "",
        count=count if is_open else 0,
        screen="" if screen.menu is None else screen.menu.title,
        instruction=screen.instruction.text,
        warnings=tuple(each.text for each in screen.warnings if each.tone in _WRONG),
        score=scores[-1] if scores else None,
        holder=holder,
        slicer=session.is_slicer_connected(),
        language=screen.language,
        assignments=_assignments(session),
    )


def _assignments(session: TrainingSession) -> str:
    told = session.curriculum
    return "" if told is None else session.assignment_words.in_brief(told)


def instruct(session: TrainingSession, flow: Flow, order: InstructorOrder, text: str) -> str:
    """Do what a teacher wants; return why it cannot be done, "" if it is."""
    if order is InstructorOrder.SAY:
        said = session.texts.say("instructor.says", text=text)
        session.notices.add(said, seconds=SENTENCE_S)
        return ""
    if order is InstructorOrder.PAUSE:
        is_shown = flow.playback is not None
        is_running = session.training.phase in (Phase.RUNNING, *PROCEDURE_PHASES)
        if not is_shown and not (is_running or session.tutorial is not None):
            return session.texts.say("instructor.nothing runs")
        flow.pause("unseen.instructor")
        return ""
    page = session.pages.top
    if isinstance(page, ReplayPage):
        return ""
    if not isinstance(page, ResultPage):
        return session.texts.say("instructor.no result")
    page.accept("replay")
    return ""
