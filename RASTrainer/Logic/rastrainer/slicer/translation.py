"""Slicer's translation of texts for users; without Slicer they stay English.

The language does not change while Slicer runs, and `slicer.i18n.tr` looks up its caller's file at
each call: so each text is translated once for each file. Like `tr` it takes the file for the
context, and a translation without the same placeholders for none.
"""

from __future__ import annotations

import logging
import string
import sys

try:
    from slicer.i18n import getContext, translate
except ImportError:  # The package slicer-core has no translations.

    def _(text: str) -> str:
        return text

else:
    _known: dict[tuple[str, str], str] = {}

    def _(text: str) -> str:
        key = (sys._getframe(1).f_code.co_filename, text)
        if key not in _known:
            translated = translate(getContext(key[0]), text)
            if _placeholders(translated) != _placeholders(text):
                logging.warning(
                    "The translation “%s” of “%s” lacks a placeholder.", translated, text
                )
                translated = text
            _known[key] = translated
        return _known[key]

    def _placeholders(text: str) -> set[str | None] | None:
        try:
            return {field for _literal, field, _spec, _conversion in string.Formatter().parse(text)}
        except ValueError:
            return None


__all__ = ["_"]
