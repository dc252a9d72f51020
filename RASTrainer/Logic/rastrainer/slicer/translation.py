"""Slicer's translation of texts for users; without Slicer they stay English."""

from __future__ import annotations

try:
    from slicer.i18n import tr as _
except ImportError:  # The package slicer-core has no translations.

    def _(text: str) -> str:
        return text


__all__ = ["_"]
