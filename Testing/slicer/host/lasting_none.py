"""Keeps Python 3.10 and 3.11 alive under PySide6 6.12.

Its functions without a result drop one reference to None too many (each `label.setText` does); from
Python 3.12 on None needs no references, before it the process ends after some thousand calls.
"""

from __future__ import annotations

import ctypes
import sys

PLENTY = 1 << 40


def lend_references_to_none() -> None:
    """Give None more references than a test session can drop."""
    if sys.version_info < (3, 12):
        ctypes.c_ssize_t.from_address(id(None)).value += PLENTY
