"""Say a sentence in a language, and repeat it in another.

The sentences are in one JSON file a language, sorted into sections for translators
(docs/how-to/translate.md). They are written with plain keys; the
typography of each language is added here.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from string import Formatter
from types import MappingProxyType

from rastrainer.trial import wording

NARROW_SPACE = "\u202f"
"""No-break, narrower than a space."""
NO_BREAK_SPACE = "\u00a0"


def _french(text: str) -> str:
    """Return a French text with its apostrophes, and no-break spaces next to signs of two parts."""
    text = re.sub(r" ([:;!?%»])", rf"{NARROW_SPACE}\1", text)
    return text.replace("« ", f"«{NARROW_SPACE}").replace("'", "’")


_TYPESETTING: Mapping[str, Callable[[str], str]] = {
    "fr": _french,
    "zh-Hans": partial(re.sub, r" (?=[\d{/])|(?<=[\d}/]) ", NO_BREAK_SPACE),
}


def _table(tag: str) -> dict[str, str]:
    content = Path(__file__).with_name(f"{tag}.json").read_text(encoding="utf-8")
    typeset = _TYPESETTING.get(tag, str)
    sections = json.loads(content).values()
    return {key: typeset(text) for section in sections for key, text in section.items()}


ENGLISH: Mapping[str, str] = MappingProxyType(
    _table("en")
    | {start + key: text for start, own in wording.TABLES.items() for key, text in own.items()}
)
LANGUAGES: Mapping[str, Mapping[str, str]] = MappingProxyType(
    {"en": ENGLISH} | {tag: MappingProxyType(_table(tag)) for tag in ("de", "fr", "es", "zh-Hans")}
)
"""BCP 47 tag → table. Sentences missing from a table are said in English."""


class LocalizedText(str):
    """A sentence that remembers how it was made, so that a view can show it in its own language."""

    key: str
    values: Mapping[str, object]

    def __new__(cls, text: str, key: str, values: Mapping[str, object]) -> LocalizedText:
        said = super().__new__(cls, text)
        said.key = key
        said.values = values
        return said

    def __reduce__(self) -> tuple[type[LocalizedText], tuple[str, str, Mapping[str, object]]]:
        """Return what a copy is made from, such as one for another process."""
        return LocalizedText, (str(self), self.key, self.values)


def key_of(sentence: str) -> str:
    """Return the key of a sentence; "" if it is not ours."""
    return sentence.key if isinstance(sentence, LocalizedText) else ""


class _Formatter(Formatter):
    """Fills in values; numbers get the language's decimal sign and a true minus sign."""

    def __init__(self, decimal_sign: str) -> None:
        self._decimal_sign = decimal_sign

    def format_field(self, value: object, format_spec: str) -> str:
        text = format(value, format_spec)
        if isinstance(value, (int, float)):
            text = text.replace("-", "−")
        return text.replace(".", self._decimal_sign) if isinstance(value, float) else text


class Texts:
    """Says the sentences, in the language of its table."""

    def __init__(self, table: Mapping[str, str] = ENGLISH) -> None:
        self._table = {**ENGLISH, **table}
        self._formatter = _Formatter(self._table["decimal sign"])

    def __contains__(self, key: str) -> bool:
        return key in self._table

    def say(self, key: str, **values: object) -> LocalizedText:
        return LocalizedText(self._formatter.vformat(self._table[key], (), values), key, values)

    def listed(self, words: Iterable[str]) -> str:
        """Return words one after the other, with the language's separator between them."""
        return self._table["list separator"].join(words)

    def again(self, sentence: str) -> str:
        """Return a sentence in this language; an unknown sentence stays as it is."""
        return (
            self.say(sentence.key, **sentence.values)
            if isinstance(sentence, LocalizedText)
            else sentence
        )


say = Texts().say
"""Returns a sentence in English; views say it again in their language."""

NO_NAMES: Mapping[str, str] = MappingProxyType({})


def pair_label(first: str, second: str) -> str:
    """Return the common name of two inputs, such as "Stick left / right"."""
    shared, _, last = second.rpartition(" ")
    return f"{first} / {last if first.rpartition(' ')[0] == shared else second}"


def input_label(
    texts: Texts, device: str, name: str, key_names: Mapping[str, str] = NO_NAMES
) -> str:
    """Return the name of an input; of a key, its label, by default on an American keyboard."""
    if f"{device}.{name}" in texts:
        return texts.say(f"{device}.{name}")
    written = key_names.get(name, name.removeprefix("Key").removeprefix("Digit"))
    # The capital of ß is two letters, and on no key.
    return written.upper() if len(written.upper()) == len(written) == 1 else written
