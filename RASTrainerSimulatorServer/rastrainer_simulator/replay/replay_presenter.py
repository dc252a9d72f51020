"""The screen and the controls of the views while a recorded trial is played."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from functools import reduce

from rastrainer.number_text import clock
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS, Bindings
from rastrainer_simulator.input.gamepads import w3c_gamepad_inputs
from rastrainer_simulator.input.inputs import ControlContext, ControlName, InputDevice
from rastrainer_simulator.presentation.feedback_event import feedback_event, feedback_of
from rastrainer_simulator.presentation.messages import InstructorOrder
from rastrainer_simulator.presentation.presenter import Presenter
from rastrainer_simulator.presentation.screen import Hint, Screen, ScreenMessage
from rastrainer_simulator.replay.playback import PERIOD_S, Playback
from rastrainer_simulator.state import SimulationState, StepResult
from rastrainer_simulator.texts.texts import LANGUAGES, Texts, input_label, pair_label
from rastrainer_simulator.viewpoint.best_view import BestView, BestViews
from rastrainer_simulator.viewpoint.view_control import (
    STILL,
    Pictures,
    ViewControl,
    camera_pose,
    orbit_to,
)

STEP_S = 5.0
SLOWLY = 0.5
"""Speed at which the worst touch is shown."""


@dataclass
class Player:
    """Carries out the viewer's actions.

    `end` is called when the viewer ends it; `blinded` as of `ReplayPresenter`.
    """

    playback: Playback
    end: Callable[[], None]
    blinded: str = ""

    def do(self, control: ControlName) -> None:
        """Do what a control of the menus does during a replay; others do nothing."""
        playback = self.playback
        match control:
            case ControlName.ACCEPT | ControlName.PAUSE:
                playback.pause(playback.is_playing)
            case ControlName.LEFT:
                playback.play_from(playback.time_s - STEP_S)
            case ControlName.RIGHT:
                playback.play_from(playback.time_s + STEP_S)
            case ControlName.CAMERA:
                names, shown = tuple(playback.setup.scenario.cameras), playback.latest.camera
                place = names.index(shown) if shown in names else -1
                playback.use_camera(names[(place + 1) % len(names)])
            case ControlName.BACK | ControlName.MENU:
                self.end()
            case ControlName.UP if playback.trial.worst is not None and not self.blinded:
                _label, begin, end = playback.trial.worst
                playback.play_from(begin, end, SLOWLY)

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


_WORST = {InputDevice.KEYBOARD: "KeyT", InputDevice.GAMEPAD: "x"}
"""Additional inputs for the worst touch, which no control of the menus uses."""


def replay_control(bindings: Bindings, device: InputDevice, name: str) -> ControlName | None:
    """Return what an input works during a replay: as in menus, and it may change the camera."""
    control = bindings.control(device, name, ControlContext.MENU)
    if control is None and name in bindings.table(device)[ControlName.CAMERA]:
        return ControlName.CAMERA
    return ControlName.UP if control is None and name == _WORST[device] else control


IN_MENUS = {ControlName.TOUCH: ControlName.ACCEPT, ControlName.UNDO: ControlName.BACK}
"""What the controls of the work do there, pressed by name."""
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
        """Play a trial; `end` is called when the user has seen enough; `language` is a BCP 47 tag.

        `blinded` is what a rater reads in place of task and trainee, who also is not led to the
        worst touch, which only the truth reveals; "" for everybody else.
        """
        super().__init__()
        self._language = language
        self._texts = Texts(LANGUAGES[language])
        self._count = 0
        self._held: dict[int, Sequence[str]] = {}
        self._key_names: Mapping[str, str] = {}
        self._end = end
        self.screen = Screen()
        self._play(playback, blinded)

    def _play(self, playback: Playback, blinded: str) -> None:
        self._playback = playback
        self._view = ViewControl()
        self._best = BestViews()
        self._search: Future[BestView | None] | None = None
        self._wants_worst = False
        self._player = Player(playback, self._end, blinded)
        self._blinded = blinded
        playback.changed = self._refresh
        playback.subscribe(self._follow)
        self._refresh()

    def pictures(self, now: SimulationState) -> Pictures:
        self._view.use(now.camera)
        camera = self._playback.setup.scenario.cameras[now.camera]
        return Pictures(camera_pose(camera, self._view.orbit))

    def instruct(self, order: InstructorOrder, text: str) -> str:  # noqa: ARG002
        """Refuse: a recorded trial takes no orders."""
        return self._texts.say("instructor.nothing runs")

    def on_orbit(self, view: int, around_deg: float, higher_deg: float, zoom: float) -> None:  # noqa: ARG002
        self._wants_worst = False
        camera = self._playback.setup.scenario.cameras[self._playback.latest.camera]
        self._view.turn(camera, around_deg, higher_deg, zoom)

    def view_left(self, view: int) -> None:
        self._held.pop(view, None)

    def on_key(self, view: int, code: str, is_down: bool, text: str) -> None:  # noqa: ARG002
        if is_down:
            self.input_pressed(InputDevice.KEYBOARD, code)

    def on_layout(self, view: int, keys: Mapping[str, str]) -> None:  # noqa: ARG002
        self._key_names = keys
        self._refresh()

    def on_pad(self, view: int, axes: Sequence[float], buttons: Sequence[float]) -> None:
        inputs = w3c_gamepad_inputs(axes, buttons)
        before = self._held.get(view, ())
        self._held[view] = held = [name for name, value in inputs.items() if value > 0.5]
        for name in held:
            if name not in before:
                self.input_pressed(InputDevice.GAMEPAD, name)

    def on_press(self, view: int, control: str) -> None:  # noqa: ARG002
        if control in ControlName._value2member_map_:
            name = ControlName(control)
            self._do(IN_MENUS.get(name, name))

    def on_visibility(self, view: int, is_visible: bool) -> None:  # noqa: ARG002
        if not is_visible:
            self._playback.pause(True)

    def on_silence(self, view: int) -> None:  # noqa: ARG002
        self._playback.pause(True)

    def input_pressed(self, device: InputDevice, name: str) -> None:
        control = replay_control(DEFAULT_BINDINGS, device, name)
        if control is not None:
            self._do(control)

    def _do(self, control: ControlName) -> None:
        self._player.do(control)
        if control in (ControlName.UP, ControlName.CAMERA):
            self._wants_worst = control is ControlName.UP and not self._blinded
        playback = self._playback
        now, worst = playback.latest, playback.trial.worst
        if worst is None or not self._wants_worst:
            return
        if self._search is None:
            head_to_world = now.head_to_world.copy()
            head_to_world[:3, 3] *= MM_PER_M
            self._best.look(playback.setup, playback.trial.task, head_to_world)
        self._search = self._best.search(worst[0], now.q)

    def _follow(self, result: StepResult) -> None:
        """Publish the events as sounds and vibration, and move the view.

        It goes to the best view of the worst touch if that is wanted, as soon as it is known.
        """
        for event in result.events:
            kind = feedback_event(event, result.state.touch)
            if kind is not None:
                self._count += 1
                self.updates.publish(feedback_of(kind, self._count))
        is_found = self._wants_worst and self._search is not None and self._search.done()
        view = self._search.result() if self._search is not None and is_found else None
        camera = self._playback.setup.scenario.cameras[result.state.camera]
        self._view.use(result.state.camera)
        if view is not None:
            self._wants_worst = False
            self._view.go(orbit_to(camera, view.eye, view.fiducial))
        self._view.advance(PERIOD_S, camera, STILL, is_arm_still=True)

    def _refresh(self) -> None:
        screen = self._make_screen()
        if screen != self.screen:
            self.screen = screen
            self.updates.publish(screen)

    def _make_screen(self) -> Screen:
        hints = []
        for codes, key in _OF_RATERS if self._blinded else _HINTS:
            labels = (input_label(self._texts, "keyboard", code, self._key_names) for code in codes)
            item = RATE if key == "hint.rate" else ""
            hints.append(Hint(reduce(pair_label, labels), self._texts.say(key), item))
        return self._player.screen(self._texts, tuple(hints), self._language)
