"""Texts of a peer: Slicer hands over `bytes` where they are not UTF-8."""

from __future__ import annotations

from rastrainer.errors import InputError


def decodedText(text: str | bytes | None) -> str:
    """Return the text, empty where there is none.

    Raises:
        InputError: it is not UTF-8.
    """
    if isinstance(text, bytes):
        raise InputError("The text must be encoded in UTF-8.")
    return text or ""


def shownText(text: str | bytes | None) -> str:
    """Return a text to be shown, such as a label: what is not UTF-8 in it is replaced."""
    return text.decode("utf-8", "replace") if isinstance(text, bytes) else text or ""
