"""Where a line may end: at spaces, and between Chinese characters."""

from __future__ import annotations

import re
from collections.abc import Iterator

WIDE = "\u2e80-\u9fff\uf900-\ufaff\uff00-\uffef"
"""Chinese characters and their punctuation, for a class of characters of an expression."""
_BEGINS_NO_LINE = r"\s。，、；：？！）”」》…—%°,.;:?!)"
_ENDS_NO_LINE = r"\s（“「《("
_AT_A_CHARACTER = f"(?<=[{WIDE}])|(?=[{WIDE}])"
_BEFORE_THE_LAST = f"[{WIDE}][{_BEGINS_NO_LINE}]*$"
_BREAK = re.compile(
    f"(?<![{_ENDS_NO_LINE}])(?:{_AT_A_CHARACTER})(?![{_BEGINS_NO_LINE}]|{_BEFORE_THE_LAST})"
)


def pieces(paragraph: str) -> Iterator[tuple[str, str]]:
    """Yield what no line may break, each after what stands between it and the piece before.

    That is a space, or nothing between Chinese characters. No-break spaces do not break, and no
    Chinese character is left alone on the last line.
    """
    for word in filter(None, paragraph.split(" ")):
        between = " "
        for piece in filter(None, _BREAK.split(word)):
            yield between, piece
            between = ""
