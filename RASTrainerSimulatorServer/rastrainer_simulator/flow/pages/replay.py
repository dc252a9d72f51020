"""The trial that was just registered, shown again."""

from __future__ import annotations

from rastrainer.errors import InputError
from rastrainer_simulator.controls.control_name import ControlName, Situation
from rastrainer_simulator.controls.inputs import Device
from rastrainer_simulator.flow.feedback import happening
from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.screen import Fact, Hint, Menu, Screen
from rastrainer_simulator.flow.session import Session
from rastrainer_simulator.replaying.film_making import FilmMaking
from rastrainer_simulator.replaying.player import ACTIONS, Action, Player
from rastrainer_simulator.replaying.replay_loop import ReplayLoop
from rastrainer_simulator.state import StepResult

_WORST = {Device.KEYBOARD: "KeyT", Device.GAMEPAD: "x"}
"""Further inputs for the worst touch, which no control of the menus needs."""


class ReplayPage(Page):
    """Waits for the film, and plays it to whoever holds the control.

    Attributes:
        replay: what is played; None while the film is being made.
    """

    name = "replay"

    def __init__(self, session: Session, making: FilmMaking, begins_at_worst: bool) -> None:
        """`begins_at_worst` shows the worst touch at first."""
        super().__init__(session)
        self.replay: ReplayLoop | None = None
        self._making = making
        self._begins_at_worst = begins_at_worst
        self._player: Player | None = None

    def menu(self) -> Menu:
        """Return how far the film is."""
        percent = self.say("replay.percent", percent=100.0 * self._making.share)
        done = Fact(self.say("replay.done"), percent)
        button = self.button("back")
        return Menu(self.name, self.say("replay.making"), (), (done,), (button,))

    def screen(self) -> Screen | None:
        """Return what is read while it is played."""
        if self._player is None:
            return None
        session = self.session
        return self._player.screen(session.texts, self._hints(), session.preferences.language)

    def advance(self, dt: float) -> None:
        """Go on, or begin as soon as the film is there."""
        if self.replay is not None:
            self.replay.advance(dt)
        elif self._making.film.done():
            self._begin()

    def accept(self, item: str) -> None:  # noqa: ARG002
        """Go back to the result."""
        self.back()

    def pressed(self, control: ControlName) -> bool:
        """Steer the film; before it is there, the menu is steered."""
        if self._player is None:
            return False
        if control in ACTIONS:
            self._player.do(ACTIONS[control])
        return True

    def input_pressed(self, device: Device, name: str) -> bool:
        """Take what has no meaning in menus: the worst touch, and the camera as while working."""
        bindings = self.session.bindings
        if self._player is None or bindings.control(device, name, Situation.MENU) is not None:
            return False
        is_camera = name in bindings.table(device)[ControlName.CAMERA]
        if is_camera or name == _WORST[device]:
            self._player.do(Action.CAMERA if is_camera else Action.WORST)
        return True

    def _begin(self) -> None:
        session = self.session
        try:
            film = self._making.film.result()
        except InputError as error:
            self.back()
            session.complain(str(error))
            return
        self.replay = ReplayLoop(film, session.setup)
        self._player = Player(self.replay, self.back)
        self.replay.subscribe(self._feel)
        if self._begins_at_worst and film.worst is None:
            session.complain(self.say("replay.no worst"))
        elif self._begins_at_worst:
            self._player.do(Action.WORST)

    def _feel(self, result: StepResult) -> None:
        """Let what happened then be heard and felt again."""
        for event in result.events:
            felt = happening(event)
            if felt is not None:
                self.session.happened(felt)

    def _hints(self) -> tuple[Hint, ...]:
        label, say = self.session.label, self.session.texts.say
        seek = self.session.pair_label(ControlName.LEFT, ControlName.RIGHT)
        return (
            Hint(label(ControlName.ACCEPT), say("hint.play")),
            Hint(seek, say("hint.seek")),
            Hint(label(ControlName.UP), say("hint.worst")),
            Hint(label(ControlName.CAMERA), say("hint.camera")),
            Hint(label(ControlName.BACK), say("hint.result")),
        )
