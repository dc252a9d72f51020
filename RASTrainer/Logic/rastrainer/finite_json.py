"""JSON as the standard has it: Python's decoder alone would let NaN and infinity through."""

from __future__ import annotations

import json
import math
from typing import Any


def decode_finite_json(text: str) -> Any:
    """Return the decoded JSON; its numbers are finite.

    Raises:
        ValueError: not JSON, too deeply nested, or with a number that is not finite.
    """
    try:
        return json.loads(text, parse_constant=_refuse_constant, parse_float=_finite_float)
    except RecursionError:
        raise ValueError("too deeply nested") from None


def _refuse_constant(word: str) -> float:
    raise ValueError(f"{word} is no number")


def _finite_float(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise ValueError(f"{digits} is too large a number")
    return value
