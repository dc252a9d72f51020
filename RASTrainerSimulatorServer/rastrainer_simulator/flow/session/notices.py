"""Sentences that are shown for a while, and warnings that are shown until they are called off."""

from __future__ import annotations

from collections.abc import Mapping

from rastrainer_simulator.presentation.screen import ScreenMessage, Tone
from rastrainer_simulator.texts.texts import Texts

NOTICE_S = 5.0


class Notices:
    """What is said beside the instruction."""

    def __init__(self) -> None:
        self._time = 0.0
        self._brief: list[tuple[float, ScreenMessage]] = []
        self._lasting: dict[str, tuple[str, Mapping[str, object]]] = {}

    def advance(self, dt: float) -> None:
        """Advance by `dt` seconds."""
        self._time += dt

    def add(self, text: str, tone: Tone = Tone.PLAIN, seconds: float = NOTICE_S) -> None:
        """Show a sentence for some seconds."""
        self._brief = [each for each in self._brief if each[1].text != text]
        self._brief.append((self._time + seconds, ScreenMessage(text, tone)))

    def warn(self, about: str, key: str = "", **values: object) -> None:
        """Show a warning until it is called off by an empty key."""
        self._lasting.pop(about, None)
        if key:
            self._lasting[about] = key, values

    def brief(self) -> tuple[ScreenMessage, ...]:
        """Return the sentences that are still to be shown."""
        self._brief = [each for each in self._brief if each[0] > self._time]
        return tuple(message for _, message in self._brief)

    def lasting(self, texts: Texts) -> tuple[ScreenMessage, ...]:
        """Return the warnings that have not been called off."""
        said = (texts.say(key, **values) for key, values in self._lasting.values())
        return tuple(ScreenMessage(text, Tone.WARNING) for text in said)
