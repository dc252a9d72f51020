"""What the views show and take while a trial is shown again."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from rastrainer_simulator.controls.control_name import ControlName
from rastrainer_simulator.flow.feedback import SENSATIONS, happening
from rastrainer_simulator.flow.screen import Hint, Message, Screen, Tone
from rastrainer_simulator.replaying.replay_loop import ReplayLoop
from rastrainer_simulator.state import StepResult
from rastrainer_simulator.subscribers import Subscribers
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from rastrainer_simulator.view_server.operator_desk import Control, Feedback, Frames, Hello, News

STEP_S = 5.0
SLOWLY = 0.5
"""Speed at which the worst touch is shown."""

_PLAY, _BACK, _FORTH, _WORST, _CAMERA, _END = "play", "back", "forth", "worst", "camera", "end"
_KEYS = {
    "Space": _PLAY,
    "Enter": _PLAY,
    "ArrowLeft": _BACK,
    "ArrowRight": _FORTH,
    "KeyT": _WORST,
    "KeyC": _CAMERA,
    "Escape": _END,
}
"""W3C `KeyboardEvent.code` → what it does."""
_PAD = {0: _PLAY, 14: _BACK, 15: _FORTH, 2: _WORST, 3: _CAMERA}
"""Buttons of the W3C standard gamepad."""
_PRESSES = {
    ControlName.TOUCH.value: _PLAY,
    ControlName.UNDO.value: _WORST,
    ControlName.CAMERA.value: _CAMERA,
    ControlName.LEFT.value: _BACK,
    ControlName.RIGHT.value: _FORTH,
}
_HINTS = (
    ("Space", "hint.play"),
    ("← →", "hint.seek"),
    ("T", "hint.worst"),
    ("C", "hint.camera"),
    ("Esc", "hint.end"),
)


class ReplayDesk:
    """An `OperatorDesk` whose user plays, pauses and seeks; nobody drives the arm.

    Attributes:
        screen: what is read.
        control: held by nobody.
    """

    control = Control()

    def __init__(self, loop: ReplayLoop, language: str, end: Callable[[], None]) -> None:
        """`language` is a BCP 47 tag; `end` is called when the user has seen enough."""
        self._loop = loop
        self._language = language
        self._texts = Texts(LANGUAGES[language])
        self._subscribers: Subscribers[News] = Subscribers()
        self._count = 0
        self._held: dict[int, frozenset[int]] = {}
        self._does = {
            _PLAY: lambda: loop.pause(loop.is_playing),
            _BACK: lambda: loop.play_from(loop.time_s - STEP_S),
            _FORTH: lambda: loop.play_from(loop.time_s + STEP_S),
            _WORST: self._show_worst,
            _CAMERA: self._change_camera,
            _END: end,
        }
        self.screen = self._make_screen()
        loop.changed = self._refresh
        loop.subscribe(self._feel)

    def subscribe(self, listener: Callable[[News], None]) -> Callable[[], None]:
        """Have `listener` called with each new screen and event; returns what ends that."""
        return self._subscribers.add(listener)

    def view_joined(self, view: int, hello: Hello) -> None:
        """Take note of a view."""

    def view_left(self, view: int) -> None:
        """Forget a view."""
        self._held.pop(view, None)

    def on_key(self, view: int, code: str, is_down: bool, text: str) -> None:  # noqa: ARG002
        """Take a key."""
        if is_down:
            self._do(_KEYS.get(code))

    def on_pad(self, view: int, axes: Sequence[float], buttons: Sequence[float]) -> None:  # noqa: ARG002
        """Take a gamepad: what is newly pressed counts."""
        held = frozenset(number for number, value in enumerate(buttons) if value > 0.5)
        for number in held - self._held.get(view, frozenset()):
            self._do(_PAD.get(number))
        self._held[view] = held

    def on_press(self, view: int, control: str) -> None:  # noqa: ARG002
        """Take a button of an XR controller."""
        self._do(_PRESSES.get(control))

    def on_sticks(self, view: int, *positions: object) -> None:
        """Nobody drives."""

    def on_item(self, view: int, name: str) -> None:
        """There is no menu."""

    def on_text(self, view: int, name: str, value: str) -> None:
        """There is no menu."""

    def on_frames(self, view: int, frames: Frames) -> None:
        """Nothing is recorded."""

    def on_visibility(self, view: int, is_visible: bool) -> None:  # noqa: ARG002
        """Who does not look misses nothing."""
        if not is_visible:
            self._loop.pause(True)

    def on_silence(self, view: int) -> None:  # noqa: ARG002
        """Nor does whoever looks at a picture that stands still."""
        self._loop.pause(True)

    def _do(self, action: str | None) -> None:
        if action is not None:
            self._does[action]()

    def _show_worst(self) -> None:
        worst = self._loop.film.worst
        if worst is not None:
            _label, begin, end = worst
            self._loop.play_from(begin, end, SLOWLY)

    def _change_camera(self) -> None:
        names = tuple(self._loop.setup.scenario.cameras)
        if names:
            shown = self._loop.latest.camera
            place = names.index(shown) if shown in names else -1
            self._loop.look(names[(place + 1) % len(names)])

    def _feel(self, result: StepResult) -> None:
        """Tell what happened then, to be heard and felt again."""
        for event in result.events:
            kind = happening(event)
            if kind is None:
                continue
            self._count += 1
            felt = SENSATIONS[kind]
            data = {"rumbleMs": round(1000 * felt.seconds)}
            self._tell(Feedback(self._count, kind.value, felt.sound, 1.0, felt.rumble, data))

    def _refresh(self) -> None:
        screen = self._make_screen()
        if screen != self.screen:
            self.screen = screen
            self._tell(screen)

    def _tell(self, news: News) -> None:
        self._subscribers.tell(news)

    def _make_screen(self) -> Screen:
        loop, say = self._loop, self._texts.say
        film = loop.film
        task = film.setup.scenario.task(film.task)
        said = say("replay.title", task=task.title, trainee=film.trainee)
        if film.worst is not None and loop.speed != 1.0:
            said = say("replay.worst", point=film.worst[0])
        training = loop.latest.training
        status = [
            f"{_clock(loop.time_s)} / {_clock(film.duration_s)}",
            say("status.points", kept=len(training.touches), count=len(task.labels)),
        ]
        if not loop.is_playing:
            status.append(say("replay.paused"))
        differs = film.difference is not None
        return Screen(
            instruction=Message(said),
            warnings=(Message(say("replay.differs"), Tone.WARNING),) if differs else (),
            status=tuple(status),
            hints=tuple(Hint(key, say(name)) for key, name in _HINTS),
            language=self._language,
        )


def _clock(seconds: float) -> str:
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes:02d}:{rest:02d}"
