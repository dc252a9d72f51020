"""The start menu, the settings with the PIN that unlocks them, and quitting."""

from __future__ import annotations

import math
from concurrent.futures import Future
from functools import partial

from rastrainer_simulator.flow.pages.controls import controls_page
from rastrainer_simulator.flow.pages.experiment import DecidePage, ExperimentPage
from rastrainer_simulator.flow.pages.introduction import introduction_page
from rastrainer_simulator.flow.session import preferences
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow, page_kind
from rastrainer_simulator.flow.session.session import SessionPage, TrainingSession
from rastrainer_simulator.input.inputs import InputDevice
from rastrainer_simulator.ops.instructor_pin import LONGEST_PIN, SHORTEST_PIN, PinAnswer
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent


@page_kind("start", back=lambda _page: None)
def start_page(page: SessionPage) -> PageContent:
    """Show the first menu. It leads new trainees through the introduction once."""
    has_read = page.session.has_read_introduction
    rows = (
        page.button("train", page.open_page(ExperimentPage if has_read else introduction_page)),
        page.button("decide", page.open_page(DecidePage)),
        page.button("introduction", page.open_page(introduction_page)),
        page.button("controls", page.open_page(controls_page)),
        page.button("settings", page.open_page(settings_page)),
        page.button("quit", page.open_page(quit_page)),
    )
    return PageContent((page.say("start.text"),), rows=rows)


@page_kind("quit")
def quit_page(page: SessionPage) -> PageContent:
    def leave() -> None:
        page.session.services.quit()
        page.back()

    rows = (page.button("stay"), page.button("leave", leave))
    return PageContent((page.say("quit.text"),), rows=rows, first="stay")


@page_kind("settings")
def settings_page(page: SessionPage) -> PageContent:
    """Show one choice for each preference; any that would change a trial wait for its end."""
    session, lock = page.session, page.session.lock

    def setting(name: str) -> PageRow:
        waits = session.has_open_trial and name in preferences.OF_A_TRIAL
        is_locked = lock.is_locked and name not in preferences.OF_TRAINEES
        help_ = page.say(f"settings.{name} help", file=preferences.PREFERENCES_FILE)
        if waits:
            help_ = page.say("settings.waits")
        elif is_locked:
            help_ = page.say("settings.locked")
        is_free = lock.has_pin or name not in preferences.OF_INSTRUCTORS
        is_enabled = is_free and not waits and not is_locked
        chosen = getattr(session.preferences, name)
        return page.choice(
            name,
            preferences.OPTIONS[name],
            chosen,
            shown(name, chosen),
            lambda value: session.prefer(**{name: value}),
            is_enabled=is_enabled,
            help=help_,
        )

    def shown(name: str, value: object) -> str:
        if name == "volume":
            return f"{value} %"
        if name in ("coarse", "fine"):
            return f"{value} mm/s"
        if isinstance(value, bool):
            value = "yes" if value else "no"
        return page.say(f"settings.{name}.{value}")

    unlock = page.button("unlock", page.open_page(PinPage))
    pin = unlock if lock.is_locked else page.button("lock", lock.lock)
    locks = (pin,) if lock.has_pin else ()
    rows = (*map(setting, preferences.OPTIONS), *locks, page.button("back"))
    return PageContent(rows=rows)


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
        self._asked: Future[PinAnswer] | None = None

    def content(self) -> PageContent:
        is_whole = len(self._pin) >= SHORTEST_PIN
        unlock = self.button(
            "unlock",
            self._ask,
            value="•" * len(self._pin) + "_",
            is_enabled=is_whole,
            help="" if is_whole else self.say("pin.too short"),
        )
        rows = (
            # First, so that the dots are visible even if the digits need more room than there is.
            unlock,
            *(self.button(digit, partial(self._type, digit), label=digit) for digit in DIGITS),
            self.button("delete", partial(self._type, "")),
            self.button("cancel"),
        )
        return PageContent((self.say("pin.text"),), rows=rows)

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        if device is not InputDevice.KEYBOARD or name not in {*_KEYS, _DELETE_KEY}:
            return False
        self._type(_KEYS.get(name, ""))
        self.session.pages.focus("unlock")
        self.session.happened(FeedbackEvent.FOCUS)
        return True

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Unlock and go back, or say why not, once the PIN has been checked."""
        asked, session = self._asked, self.session
        if asked is None or not asked.done():
            return
        self._asked = None
        with session.complaining():
            answer = asked.result()
            self._pin = ""
            session.lock.is_open = answer.is_right
            if answer.is_right:
                session.notices.add(self.say("pin.unlocked"))
                self.back()
            elif answer.wait_s > 0.0:
                session.complain(self.say("pin.wait", seconds=math.ceil(answer.wait_s)))
            else:
                session.complain(self.say("pin.wrong"))

    def _ask(self) -> None:
        self._asked = self._asked or self.session.lock.check(self._pin)

    def _type(self, digit: str) -> None:
        """Add a digit; "" deletes the last one."""
        self._pin = (self._pin + digit)[:LONGEST_PIN] if digit else self._pin[:-1]
