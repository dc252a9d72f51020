"""The start menu, the settings with the PIN that unlocks them, and quitting."""

from __future__ import annotations

import math
from functools import partial

from rastrainer.errors import InputError
from rastrainer_simulator.flow.pages.controls import ControlsPage
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.introduction import IntroductionPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
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


class StartPage(SessionPage):
    """The first menu. A trainee who has not read the introduction is led through it once."""

    name = "start"

    def content(self) -> PageContent:
        has_read = self.session.has_read_introduction
        rows = (
            self.button("train", self.open_page(ExperimentPage if has_read else IntroductionPage)),
            self.button("introduction", self.open_page(IntroductionPage)),
            self.button("controls", self.open_page(ControlsPage)),
            self.button("settings", self.open_page(SettingsPage)),
            self.button("quit", self.open_page(QuitPage)),
        )
        return PageContent(self.say("start.title"), (self.say("start.text"),), rows=rows)

    def back(self) -> None:
        """Do nothing: there is no previous page."""


class QuitPage(SessionPage):
    """Asks for confirmation before the simulator is shut down."""

    name = "quit"
    first = "stay"

    def content(self) -> PageContent:
        rows = (self.button("stay"), self.button("leave", self._leave))
        return PageContent(self.say("quit.title"), (self.say("quit.text"),), rows=rows)

    def _leave(self) -> None:
        self.session.quit()
        self.back()


class SettingsPage(SessionPage):
    """One choice for each preference; any that would change a running trial wait for its end."""

    name = "settings"

    def content(self) -> PageContent:
        lock = self.session.lock
        unlock = self.button("unlock", self.open_page(PinPage))
        pin = unlock if lock.is_locked else self.button("lock", lock.lock)
        rows = (
            *map(self._setting, OPTIONS),
            *((pin,) if lock.has_pin else ()),
            self.button("back"),
        )
        return PageContent(self.say("settings.title"), rows=rows)

    def _setting(self, name: str) -> PageRow:
        lock = self.session.lock
        waits = self.session.has_open_trial and name in OF_A_TRIAL
        is_locked = lock.is_locked and name not in OF_TRAINEES
        help_ = self.say(f"settings.{name} help", file=PREFERENCES_FILE)
        if waits:
            help_ = self.say("settings.waits")
        elif is_locked:
            help_ = self.say("settings.locked")
        is_enabled = not waits and not is_locked and (lock.has_pin or name not in OF_INSTRUCTORS)
        step = partial(self._step, name)
        return self.choice(name, self._value(name), step, is_enabled=is_enabled, help=help_)

    def _step(self, name: str, direction: int) -> None:
        """Choose another option, which takes effect at once."""
        self.session.prefer(self.session.preferences.stepped(name, direction))

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

    def content(self) -> PageContent:
        is_whole = len(self._pin) >= SHORTEST_PIN
        unlock = self.button(
            "unlock",
            lambda: self.session.lock.guess(self._pin),
            value="•" * len(self._pin) + "_",
            is_enabled=is_whole,
            help="" if is_whole else self.say("pin.too short"),
        )
        rows = (
            # First, so that the dots are visible even if the digits need more room than there is.
            unlock,
            *(self.button(digit, partial(self._add, digit), label=digit) for digit in DIGITS),
            self.button("delete", self._delete),
            self.button("cancel"),
        )
        return PageContent(self.say("pin.title"), (self.say("pin.text"),), rows=rows)

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        """Add a typed digit; the focus goes to the button that unlocks, for the key Enter."""
        if device is not InputDevice.KEYBOARD or name not in {*_KEYS, _DELETE_KEY}:
            return False
        if name == _DELETE_KEY:
            self._delete()
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

    def _delete(self) -> None:
        self._pin = self._pin[:-1]
