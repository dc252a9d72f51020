"""The start menu, the settings with the PIN that unlocks them, and quitting."""

from __future__ import annotations

import math

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.controls import ControlsPage
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.introduction import IntroductionPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.preferences import (
    OF_A_TRIAL,
    OF_INSTRUCTORS,
    OF_TRAINEES,
    OPTIONS,
    PREFERENCES_FILE,
)
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import InputDevice
from rastrainer_simulator.ops.instructor_pin import LONGEST_PIN, SHORTEST_PIN
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import Menu, MenuItem


class StartPage(SessionPage):
    """The first menu. A trainee who has not read the introduction is led through it once."""

    name = "start"

    def menu(self) -> Menu:
        """Return the start menu."""
        items = ("train", "introduction", "controls", "settings", "quit")
        return Menu(
            self.name,
            self.say("start.title"),
            paragraphs=(self.say("start.text"),),
            items=tuple(self.button(item) for item in items),
        )

    def accept(self, item: str) -> None:
        """Open what was chosen."""
        if item == "train" and self.session.has_read_introduction:
            self.session.pages.open(ExperimentPage(self.session))
            return
        pages = {
            "train": IntroductionPage,
            "introduction": IntroductionPage,
            "controls": ControlsPage,
            "settings": SettingsPage,
            "quit": QuitPage,
        }
        self.session.pages.open(pages[item](self.session))

    def back(self) -> None:
        """Do nothing: there is no previous page."""


class QuitPage(SessionPage):
    """Asks for confirmation before the simulator is shut down."""

    name = "quit"
    first = "stay"

    def menu(self) -> Menu:
        """Return the question."""
        items = (self.button("stay"), self.button("leave"))
        return Menu(self.name, self.say("quit.title"), (self.say("quit.text"),), items=items)

    def accept(self, item: str) -> None:
        if item == "leave":
            self.session.quit()
        self.session.pages.close()


class SettingsPage(SessionPage):
    """One choice for each preference; any that would change a running trial wait for its end."""

    name = "settings"

    def menu(self) -> Menu:
        """Return the choices."""
        items = tuple(self._item(name) for name in OPTIONS)
        lock = self.session.lock
        pin = (self.button("unlock" if lock.is_locked else "lock"),) if lock.has_pin else ()
        items = (*items, *pin, self.button("back"))
        return Menu(self.name, self.say("settings.title"), items=items)

    def accept(self, item: str) -> None:
        """Go back, ask for the PIN, or lock again."""
        if item == "back":
            self.back()
        elif item == "unlock":
            self.session.pages.open(PinPage(self.session))
        else:
            self.session.lock.lock()

    def step(self, item: str, direction: int) -> None:
        """Choose another option, which takes effect at once."""
        self.session.prefer(self.session.preferences.stepped(item, direction))

    def _item(self, name: str) -> MenuItem:
        lock = self.session.lock
        waits = self.session.has_open_trial and name in OF_A_TRIAL
        is_locked = lock.is_locked and name not in OF_TRAINEES
        help_ = self.say("settings.waits") if waits else self._help(name)
        is_enabled = not waits and not is_locked and (lock.has_pin or name not in OF_INSTRUCTORS)
        return self.choice(name, self._value(name), is_enabled=is_enabled, help=help_)

    def _help(self, name: str) -> str:
        if self.session.lock.is_locked and name not in OF_TRAINEES:
            return self.say("settings.locked")
        return self.say(f"settings.{name} help", file=PREFERENCES_FILE)

    def _value(self, name: str) -> str:
        value = getattr(self.session.preferences, name)
        if name == "volume":
            return f"{value} %"
        if name in ("coarse", "fine"):
            return f"{value} mm/s"
        if isinstance(value, bool):
            value = "yes" if value else "no"
        return self.say(f"settings.{name}.{value}")


DIGITS = "1234567890"
_KEYS = {f"{key}{digit}": digit for key in ("Digit", "Numpad") for digit in DIGITS}
_DELETE_KEY = "Backspace"


class PinPage(SessionPage):
    """Accepts digits, shows a dot for each, and unlocks if they are right.

    Typed digits never are the value of an item: that would be sent to every view.
    """

    name = "pin"
    is_private = True

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._pin = ""

    def menu(self) -> Menu:
        """Return the digits, and the actions on them."""
        is_whole = len(self._pin) >= SHORTEST_PIN
        digits = tuple(self.button(digit, label=digit) for digit in DIGITS)
        help_ = "" if is_whole else self.say("pin.too short")
        dots = "•" * len(self._pin) + "_"
        # First, so that the dots are visible even if the digits need more room than there is.
        unlock = self.button("unlock", value=dots, is_enabled=is_whole, help=help_)
        items = (unlock, *digits, self.button("delete"), self.button("cancel"))
        return Menu(self.name, self.say("pin.title"), (self.say("pin.text"),), items=items)

    def accept(self, item: str) -> None:
        """Add or remove a digit, have the PIN checked, or leave."""
        if item == "cancel":
            self.back()
        elif item == "unlock":
            self.session.lock.guess(self._pin)
        elif item == "delete":
            self._pin = self._pin[:-1]
        else:
            self._add(item)

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Add a typed digit; the focus goes to the button that unlocks, for the key Enter."""
        if device is not InputDevice.KEYBOARD or name not in {*_KEYS, _DELETE_KEY}:
            return False
        if name == _DELETE_KEY:
            self._pin = self._pin[:-1]
        else:
            self._add(_KEYS[name])
        self.session.pages.focus("unlock")
        self.session.happened(FeedbackEvent.FOCUS)
        return True

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Unlock and go back, or say why not, once the PIN has been checked."""
        session = self.session
        try:
            answer = session.lock.take_answer()
        except InputError as error:
            session.complain(str(error))
            return
        if answer is None:
            return
        self._pin = ""
        if answer.is_right:
            session.notices.add(self.say("pin.unlocked"))
            self.back()
        elif answer.wait_s > 0.0:
            session.complain(self.say("pin.wait", seconds=math.ceil(answer.wait_s)))
        else:
            session.complain(self.say("pin.wrong"))

    def closed(self) -> None:
        self._pin = ""
        self.session.lock.forget_guess()

    def _add(self, digit: str) -> None:
        self._pin = (self._pin + digit)[:LONGEST_PIN]
