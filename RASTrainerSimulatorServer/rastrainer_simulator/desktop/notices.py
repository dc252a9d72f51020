"""The few sentences that the window says itself, because the simulator cannot."""

from __future__ import annotations

from rastrainer_simulator.flow.screen import Menu, Screen
from rastrainer_simulator.texts.texts import LANGUAGES, Texts


def notice(key: str, language: str) -> Screen:
    """Return what the trainee reads while there is no connection."""
    texts = Texts(LANGUAGES.get(language, {}))
    return Screen(menu=Menu("notice", texts.say("window.title"), (texts.say(key),)))
