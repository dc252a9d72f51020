"""The few sentences that the window says itself, because the simulator cannot."""

from __future__ import annotations

from functools import lru_cache

from rastrainer_simulator.flow.screen import Menu, Screen
from rastrainer_simulator.texts.texts import LANGUAGES, Texts


def notice(key: str, language: str) -> Screen:
    """Return what the trainee reads while there is no connection."""
    texts = Texts(LANGUAGES.get(language, {}))
    return Screen(menu=Menu("notice", texts.say("window.title"), (texts.say(key),)))


@lru_cache(maxsize=8)
def own_facts(language: str, holder: str, pairing: tuple[str, str] | None) -> tuple[str, ...]:
    """Return who holds the control, and how another view is paired where that is to be told."""
    texts = Texts(LANGUAGES.get(language, {}))
    key = f"source.{holder}"
    source = texts.say(key) if key in texts else holder
    fact = texts.say("control.holder", source=source) if holder else texts.say("control.nobody")
    if pairing is None:
        return (fact,)
    code, addresses = pairing
    return fact, texts.say("window.pairing", code=code, addresses=addresses)
