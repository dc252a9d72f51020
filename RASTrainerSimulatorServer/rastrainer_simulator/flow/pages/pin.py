"""Where an instructor enters the PIN: typed, or digit by digit by whatever one operates with."""

from __future__ import annotations

import math

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import InputDevice
from rastrainer_simulator.net.views.feedback_event import FeedbackEvent
from rastrainer_simulator.net.views.screen import Menu
from rastrainer_simulator.ops.instructor_pin import LONGEST_PIN, SHORTEST_PIN

DIGITS = "1234567890"
_KEYS = {f"{key}{digit}": digit for key in ("Digit", "Numpad") for digit in DIGITS}
_DELETE_KEY = "Backspace"


class PinPage(SessionPage):
    """Takes digits, shows a dot for each, and unlocks by the right ones.

    Typed digits never are the value of an item: that would be sent to every view.
    """

    name = "pin"
    is_private = True

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._pin = ""

    def menu(self) -> Menu:
        """Return the digits, and what is done with them."""
        is_whole = len(self._pin) >= SHORTEST_PIN
        digits = tuple(self.button(digit, label=digit) for digit in DIGITS)
        help_ = "" if is_whole else self.say("pin.too short")
        dots = "•" * len(self._pin) + "_"
        # First, so that the dots are seen wherever the digits need more room than there is.
        unlock = self.button("unlock", value=dots, is_enabled=is_whole, help=help_)
        items = (unlock, *digits, self.button("delete"), self.button("cancel"))
        return Menu(self.name, self.say("pin.title"), (self.say("pin.text"),), items=items)

    def accept(self, item: str) -> None:
        """Take a digit or take it back, have the PIN looked at, or leave."""
        if item == "cancel":
            self.back()
        elif item == "unlock":
            self.session.lock.guess(self._pin)
        elif item == "delete":
            self._pin = self._pin[:-1]
        else:
            self._add(item)

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Take a digit that is typed; the focus goes to what unlocks, for the key Enter."""
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
        """Unlock and go back, or say why not, once the PIN has been looked at."""
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
        """Forget the digits."""
        self._pin = ""
        self.session.lock.forget_guess()

    def _add(self, digit: str) -> None:
        self._pin = (self._pin + digit)[:LONGEST_PIN]
