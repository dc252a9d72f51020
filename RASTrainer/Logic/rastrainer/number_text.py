"""Numbers for people: halves are rounded up, with a true minus sign."""

from __future__ import annotations

import re

_BEFORE_UNIT = re.compile(
    r"(?<=\d) (?=[%/]|(?:mm|cm|s|min|MB|of 100)(?![\w’']))|(?<=\d /) (?=\d)|(?<=,) (?=(?:mm|s)\b)"
    r"|(?<=m[aá]x\.) (?=\d)|(?<=最大) (?=\d)"
)
PAST_HALF = 1 + 1e-12
"""Takes a number slightly farther from 0: 0.1465, stored as 0.14649…, becomes 0.147."""


def with_units(text: str) -> str:
    """Return a text in which no line ends between a number, or a name, and its unit or limit."""
    return _BEFORE_UNIT.sub("\N{NO-BREAK SPACE}", text)


def fixed(value: float, digits: int) -> str:
    text = f"{value * PAST_HALF:.{digits}f}"
    if float(text) == 0:
        # Zero has no sign.
        text = text.removeprefix("-")
    return text.replace("-", "−")


def signed(value: float, digits: int) -> str:
    """Return a number with `digits` decimals and its sign, also +."""
    text = fixed(value, digits)
    return text if text.startswith("−") or float(text) == 0 else f"+{text}"


def significant(value: float, digits: int = 3, sign: bool = False) -> str:
    return f"{value * PAST_HALF:{'+' if sign else ''}.{digits}g}".replace("-", "−")


def p_text(p: float) -> str:
    """Return a p-value with three decimals and no leading zero, as in papers."""
    return "< .001" if p < 0.001 else fixed(p, 3).removeprefix("0")


def p_phrase(p: float) -> str:
    """Return a p-value for a sentence, without line breaks: `p = .125` or `p < .001`."""
    text = p_text(p)
    words = f"p {text}" if text.startswith("<") else f"p = {text}"
    return words.replace(" ", "\N{NO-BREAK SPACE}")


def percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def clock(seconds: float) -> str:
    """Return a duration as minutes and seconds: `02:05`."""
    minutes, rest = divmod(int(seconds), 60)
    return f"{minutes:02d}:{rest:02d}"


def counted(count: int, what: str) -> str:
    """Return a count with its noun: `1 trial`, `2 trials`."""
    return f"{count} {what}{'' if count == 1 else 's'}"
