"""The screen and the controls of the views while a recorded trial is played."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import reduce

from rastrainer.number_text import clock
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS, Bindings
from rastrainer_simulator.input.controls import InputState
from rastrainer_simulator.input.gamepads import w3c_gamepad_inputs
from rastrainer_simulator.input.inputs import (
    ControlContext,
    ControlName,
    InputDevice,
    button_in_menu,
)
from rastrainer_simulator.presentation.feedback_event import feedback_event
from rastrainer_simulator.presentation.messages import InstructorOrder
from rastrainer_simulator.presentation.presenter import Presenter
from rastrainer_simulator.presentation.screen import Hint, Screen, ScreenMessage
from rastrainer_simulator.replay.playback import PERIOD_S, Playback
from rastrainer_simulator.state import SimulationState, StepResult
from rastrainer_simulator.texts.texts import LANGUAGES, Texts, input_label, pair_label
from rastrainer_simulator.viewpoint.trial_view import TrialView
from rastrainer_simulator.viewpoint.view_control import Pictures, camera_pose

STEP_S = 5.0
SLOWLY = 0.5
"""Speed at which the worst touch is shown."""


WORST_TOO = {InputDevice.KEYBOARD: "KeyT", InputDevice.GAMEPAD: "x"}
"""Additional inputs for the worst touch, which no control of the menus uses."""


def viewer_control(bindings: Bindings, device: InputDevice, name: str) -> ControlName | None:
    """Return the control that an input works during a replay; None if it works none."""
    control = bindings.control(device, name, ControlContext.MENU)
    if control is None and name in bindings.table(device)[ControlName.CAMERA]:
        return ControlName.CAMERA
    return ControlName.UP if control is None and name == WORST_TOO[device] else control


@dataclass(frozen=True)
class Player:
    """Carries out what the viewer's controls do.

    `end` is called when the viewer ends it; `blinded` is as of `ReplayPresenter`.
    """

    playback: Playback
    end: Callable[[], None]
    blinded: str = ""

    def do(self, control: ControlName) -> None:
        playback, worst = self.playback, self.playback.trial.worst
        match control:
            case ControlName.ACCEPT | ControlName.PAUSE:
                playback.pause(playback.is_playing)
            case ControlName.LEFT:
                playback.play_from(playback.time_s - STEP_S)
            case ControlName.RIGHT:
                playback.play_from(playback.time_s + STEP_S)
            case ControlName.CAMERA:
                names, now = tuple(playback.setup.scenario.cameras), playback.latest.camera
                place = names.index(now) if now in names else -1
                playback.use_camera(names[(place + 1) % len(names)])
            case ControlName.BACK | ControlName.MENU:
                self.end()
            case ControlName.UP if worst is not None and not self.blinded:
                playback.play_from(*worst[1:], SLOWLY)

    def screen(self, texts: Texts, hints: tuple[Hint, ...], language: str) -> Screen:
        """Return the present screen; `language` is the BCP 47 tag of the texts."""
        playback, say = self.playback, texts.say
        trial = playback.trial
        task = playback.setup.scenario.task(trial.task)
        instruction: str = say("replay.title", task=task.title, trainee=trial.trainee)
        if self.blinded:
            instruction = self.blinded
        elif trial.worst is not None and playback.speed != 1.0:
            instruction = say("replay.worst", point=trial.worst[0])
        kept = len(playback.latest.training.touches)
        status = [
            f"{clock(playback.time_s)} / {clock(trial.duration_s)}",
            say("status.points", kept=kept, count=len(task.labels)),
        ]
        if not playback.is_playing:
            status.append(say("replay.paused"))
        return Screen(
            instruction=ScreenMessage(instruction),
            status=tuple(status),
            hints=hints,
            language=language,
            sticks_navigate=True,
        )


RATE = "rate"
"""The item of the hint by which a rater who clicks leaves the replay."""
_PLAY, _CAMERA = (("Space",), "hint.play"), (("KeyC",), "hint.camera")
_SEEK = ("ArrowLeft", "ArrowRight"), "hint.seek"
_HINTS = (_PLAY, _SEEK, (("ArrowUp",), "hint.worst"), _CAMERA, (("Escape",), "hint.end"))
"""Keys, and the text of their action."""
_OF_RATERS = (_PLAY, _SEEK, _CAMERA, (("Escape",), "hint.rate"))


class ReplayPresenter(Presenter):
    """The presenter for playing, pausing and seeking; the arm is not driven."""

    def __init__(
        self, playback: Playback, language: str, end: Callable[[], None], blinded: str = ""
    ) -> None:
        """Play a trial; `end` is called when the user has seen enough.

        Args:
            language: BCP 47 tag.
            blinded: what a rater reads in place of task and trainee, who also is not led to the
                worst touch, which only the truth reveals; "" for everybody else.
        """
        super().__init__()
        self._language = language
        self._texts = Texts(LANGUAGES[language])
        self._pads: dict[int, InputState] = {}
        self._key_names: Mapping[str, str] = {}
        self._end = end
        self._play(playback, blinded)

    def _play(self, playback: Playback, blinded: str) -> None:
        self._playback = playback
        self._view = TrialView()
        self._is_view_begun = False
        self._player = Player(playback, self._end, blinded)
        self._blinded = blinded
        playback.changed = self._refresh
        playback.subscribe(self._follow)
        self._refresh()

    def pictures(self, now: SimulationState) -> Pictures:
        self._view.control.use(now.camera)
        camera = self._playback.setup.scenario.cameras[now.camera]
        return Pictures(camera_pose(camera, self._view.control.orbit))

    def instruct(self, order: InstructorOrder, text: str) -> str:  # noqa: ARG002
        """Refuse: a recorded trial takes no orders."""
        return self._texts.say("instructor.nothing runs")

    def on_orbit(self, view: int, around_deg: float, higher_deg: float, zoom: float) -> None:  # noqa: ARG002
        self._view.is_best_wanted = False
        camera = self._playback.setup.scenario.cameras[self._playback.latest.camera]
        self._view.control.turn(camera, around_deg, higher_deg, zoom)

    def view_left(self, view: int) -> None:
        self._pads.pop(view, None)

    def on_key(self, view: int, code: str, is_down: bool, text: str) -> None:  # noqa: ARG002
        if is_down:
            self._press(InputDevice.KEYBOARD, code)

    def on_layout(self, view: int, keys: Mapping[str, str]) -> None:  # noqa: ARG002
        self._key_names = keys
        self._refresh()

    def on_pad(self, view: int, axes: Sequence[float], buttons: Sequence[float]) -> None:
        pad = self._pads.setdefault(view, InputState(InputDevice.GAMEPAD))
        for name in pad.set_inputs(w3c_gamepad_inputs(axes, buttons)):
            self._press(InputDevice.GAMEPAD, name)

    def on_press(self, view: int, control: str) -> None:  # noqa: ARG002
        self._do(button_in_menu(control))

    def on_visibility(self, view: int, is_visible: bool) -> None:  # noqa: ARG002
        if not is_visible:
            self._playback.pause(True)

    def on_silence(self, view: int) -> None:  # noqa: ARG002
        self._playback.pause(True)

    def _press(self, device: InputDevice, name: str) -> None:
        self._do(viewer_control(DEFAULT_BINDINGS, device, name))

    def _do(self, control: ControlName | None) -> None:
        if control is None:
            return
        self._player.do(control)
        if control not in (ControlName.UP, ControlName.CAMERA):
            return
        playback = self._playback
        is_led = playback.trial.worst is not None and not self._blinded
        is_best_wanted = is_led and control is ControlName.UP
        if is_best_wanted and not self._is_view_begun:
            self._is_view_begun = True
            self._view.begin(playback.setup, playback.latest)
        self._view.is_best_wanted = is_best_wanted

    def _follow(self, result: StepResult) -> None:
        """Publish the events as sounds and vibration, and move the view."""
        for event in result.events:
            kind = feedback_event(event, result.state.touch)
            if kind is not None:
                self.happened(kind)
        worst = self._playback.trial.worst
        wanted = worst[0] if self._view.is_best_wanted and worst is not None else None
        training = replace(result.state.training, next_point=wanted)
        state = replace(result.state, training=training)
        self._view.advance(PERIOD_S, state, self._playback.setup.scenario)

    def _refresh(self) -> None:
        self.show(self._make_screen())

    def _make_screen(self) -> Screen:
        hints = []
        for codes, key in _OF_RATERS if self._blinded else _HINTS:
            labels = (input_label(self._texts, "keyboard", code, self._key_names) for code in codes)
            item = RATE if key == "hint.rate" else ""
            hints.append(Hint(reduce(pair_label, labels), self._texts.say(key), item))
        return self._player.screen(self._texts, tuple(hints), self._language)
