"""Set texts as a language's typography asks, so that their tables are written with plain keys."""

from __future__ import annotations

import re

NARROW_SPACE = "\u202f"
"""No-break, narrower than a space."""
NO_BREAK_SPACE = "\u00a0"


def french(text: str) -> str:
    """Return a French text with its apostrophes, and no-break spaces beside signs of two parts."""
    text = re.sub(r" ([:;!?%»])", rf"{NARROW_SPACE}\1", text)
    return text.replace("« ", f"«{NARROW_SPACE}").replace("'", "’")


def chinese(text: str) -> str:
    """Return a Chinese text with no-break spaces beside numbers and what is filled in."""
    return re.sub(r" (?=[\d{/])|(?<=[\d}/]) ", NO_BREAK_SPACE, text)
