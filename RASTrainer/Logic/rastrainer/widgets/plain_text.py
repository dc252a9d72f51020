"""Text by others, made fit to be shown: never HTML, never wider or longer than a panel.

A peer, a file or a user may send thousands of characters without a space, or tags: a label shows
them as they are, wrapped, and the first few hundred of them.
"""

from __future__ import annotations

import html
import re

LONGEST_TEXT, LONGEST_NAME, LONGEST_TITLE, LONGEST_TIP = 1500, 60, 24, 4000
"""Characters of a text in a label, a name in a list, a name in a button, and a tool tip."""

LONGEST_WORD = 32
_BREAK = "\u200b"
"""A space without width: Qt may wrap there."""

_LONG_WORD = re.compile(rf"[^\s/\-{_BREAK}]{{{LONGEST_WORD}}}(?=[^\s/\-{_BREAK}])")


def shortened(text: str, longest: int) -> str:
    """Return a text of at most `longest` characters, whose end shows that it was shortened."""
    return text if len(text) <= longest else text[: longest - 1] + "…"


def wrappable(text: str) -> str:
    """Return a text that Qt can wrap even within long words."""
    return _LONG_WORD.sub(lambda word: word.group() + _BREAK, text)


def shortName(text: str) -> str:
    """Return a name on one line, for a list or within a sentence."""
    return shortened(" ".join(text.split()), LONGEST_NAME)


def buttonTitle(text: str) -> str:
    """Return a name for a button, where an ampersand would underline the letter after it."""
    return shortened(shortName(text), LONGEST_TITLE).replace("&", "&&")


def toolTip(text: str) -> str:
    """Return a tool tip, or a question, that Qt shows as it is, wrapped.

    Qt takes text that looks like HTML for HTML, and wraps nothing else. So such text, and long
    text, is given as HTML without tags.
    """
    text = wrappable(shortened(text, LONGEST_TIP))
    if len(text) <= LONGEST_TEXT and not {"<", "&"} & set(text):
        return text
    return f"<qt>{html.escape(text)}</qt>"
