"""Standard JSON: unlike Python's decoder, without NaN and infinity, and of limited depth."""

from __future__ import annotations

import json
import math
from typing import Any

from rastrainer.errors import InputError

MAX_DEPTH = 64
"""Nesting of lists and objects; the interpreter's own limit depends on its version."""
MAX_MESSAGE_VALUES = 1000
"""Of a message to the simulator; ours have less than half as many."""
MAX_RECORD_VALUES = 25_000
"""Of a message from the simulator: a trial's record, with a procedure at all of its limits."""


def decode_finite_json(text: str, deepest: int = MAX_DEPTH) -> Any:
    """Return decoded JSON with finite numbers.

    Raises:
        ValueError: not JSON, nested more than `deepest` levels, or a number is not finite.
    """
    try:
        value = _DECODER.decode(text)
    except RecursionError:
        raise ValueError("too deeply nested") from None
    # Fast path: few brackets cannot be deep.
    if text.count("[") + text.count("{") > deepest and _is_deeper_than(deepest, value):
        raise ValueError("too deeply nested")
    if not _is_finite(value):
        # Decode again, to report the digits.
        json.loads(text, parse_float=_finite_float)
    return value


def decode_message(text: str, most: int = MAX_MESSAGE_VALUES) -> Any:
    """Return the decoded JSON of a message, which has a limited number of values.

    Python's decoder blocks all other threads; with more values than `MAX_MESSAGE_VALUES`, the
    control loop would miss a tick.

    Raises:
        ValueError: as `decode_finite_json`, or more than `most` values.
    """
    if text.count(",") >= most:
        raise ValueError("too many values")
    return decode_finite_json(text)


def decode_message_object(text: str, what: str, most: int = MAX_MESSAGE_VALUES) -> dict[str, Any]:
    """Return the JSON object of a message of at most `most` values; `what` starts the error.

    Raises:
        InputError: not a JSON object, too deep, too many values, or a number is not finite.
    """
    try:
        value = decode_message(text, most)
    except ValueError:
        value = None
    if not isinstance(value, dict):
        raise InputError(
            f"{what} must be one JSON object with finite numbers, of at most {most} values."
        )
    return value


def _is_deeper_than(deepest: int, value: Any) -> bool:
    level = [value] if isinstance(value, (dict, list)) else []
    for _ in range(deepest):
        level = [
            item
            for each in level
            for item in (each.values() if isinstance(each, dict) else each)
            if isinstance(item, (dict, list))
        ]
    return bool(level)


def _refuse_constant(word: str) -> float:
    raise ValueError(f"{word} is no number")


def _finite_float(digits: str) -> float:
    value = float(digits)
    if not math.isfinite(value):
        raise ValueError(f"{digits} is too large a number")
    return value


def _is_finite(value: Any) -> bool:
    """Return whether decoded JSON has no infinity, which digits like 1e999 become.

    Checking afterwards is much faster than a callback for each number.
    """
    values = [value]
    # The list grows during iteration.
    for each in values:
        kind = each.__class__
        if kind is float:
            if math.isinf(each):
                return False
        elif kind is list:
            values += each
        elif kind is dict:
            values += each.values()
    return True


_DECODER = json.JSONDecoder(parse_constant=_refuse_constant)
"""Shared, because `json.loads` with arguments makes a new one each time."""
