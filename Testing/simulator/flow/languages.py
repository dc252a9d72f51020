"""The languages in which screens are checked, and every screen where its words are longest."""

from __future__ import annotations

from unicodedata import east_asian_width

import pytest

from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.texts.texts import LANGUAGES
from Testing.simulator.flow.every_page import every_screen

LONGEST = "longest"
"""Each screen in the language that has the most letters on it."""
LONGEST_OR_EACH = [LONGEST, *(pytest.param(tag, marks=pytest.mark.soak) for tag in LANGUAGES)]


def screens_in(presenter: FlowPresenter, language: str) -> dict[str, Screen]:
    """Return a screen of each page in a language, or each in the language where it is longest."""
    if language != LONGEST:
        session = presenter._session
        session.prefer(language=language)
        return every_screen(presenter)
    spoken = [screens_in(presenter, tag) for tag in LANGUAGES]
    return {name: max((screens[name] for screens in spoken), key=letters) for name in spoken[0]}


def letters(screen: Screen) -> int:
    """Return how many letters are on a screen; a Chinese character is as wide as two."""
    said = [*screen.status, *(hint.control + hint.action for hint in screen.hints)]
    said += [message.text for message in (screen.instruction, *screen.warnings) if message]
    if menu := screen.menu:
        said += [menu.title, *menu.paragraphs]
        said += [fact.label + fact.value for fact in menu.facts]
        said += [item.label + item.value + item.help for item in menu.items]
    return sum(
        len(text) + sum(east_asian_width(letter) in "FW" for letter in text) for text in said
    )
