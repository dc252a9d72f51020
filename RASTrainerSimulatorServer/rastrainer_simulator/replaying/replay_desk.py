"""What the views show and take while a trial is shown again."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import reduce

from rastrainer_simulator.controls.control_name import ControlName
from rastrainer_simulator.flow.feedback import SENSATIONS, happening
from rastrainer_simulator.flow.screen import Hint, Screen
from rastrainer_simulator.replaying.player import ACTIONS, Action, Player
from rastrainer_simulator.replaying.replay_loop import ReplayLoop
from rastrainer_simulator.state import StepResult
from rastrainer_simulator.subscribers import Subscribers
from rastrainer_simulator.texts.texts import LANGUAGES, Texts, input_label, pair_label
from rastrainer_simulator.view_server.operator_desk import Control, Feedback, Frames, Hello, News

_KEYS = {
    "Space": Action.PLAY,
    "Enter": Action.PLAY,
    "ArrowLeft": Action.BACK,
    "ArrowRight": Action.FORTH,
    "ArrowUp": Action.WORST,
    "KeyT": Action.WORST,
    "KeyC": Action.CAMERA,
    "KeyM": Action.END,
    "Escape": Action.END,
}
"""W3C `KeyboardEvent.code` → what it does."""
_PAD = {
    0: Action.PLAY,
    1: Action.END,
    2: Action.WORST,
    3: Action.CAMERA,
    9: Action.END,
    12: Action.WORST,
    14: Action.BACK,
    15: Action.FORTH,
}
"""Buttons of the W3C standard gamepad."""
_PRESSES = {
    **{control.value: action for control, action in ACTIONS.items()},
    ControlName.TOUCH.value: Action.PLAY,
    ControlName.UNDO.value: Action.END,
}
_HINTS = (
    (("Space",), "hint.play"),
    (("ArrowLeft", "ArrowRight"), "hint.seek"),
    (("ArrowUp",), "hint.worst"),
    (("KeyC",), "hint.camera"),
    (("Escape",), "hint.end"),
)
"""Keys, and the text of what they do."""


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
        self._player = Player(loop, end)
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

    def _do(self, action: Action | None) -> None:
        if action is not None:
            self._player.do(action)

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
        hints = tuple(self._hint(codes, key) for codes, key in _HINTS)
        return self._player.screen(self._texts, hints, self._language)

    def _hint(self, codes: tuple[str, ...], key: str) -> Hint:
        labels = (input_label(self._texts, "keyboard", code) for code in codes)
        return Hint(reduce(pair_label, labels), self._texts.say(key))
