"""JSON as the standard has it: Python's decoder alone would let NaN and infinity through."""

from __future__ import annotations

import json
import math
from typing import Any

from rastrainer.errors import InputError

MAX_DEPTH = 64
"""Lists and objects in one another; how many the interpreter takes differs with its version."""
MAX_MESSAGE_VALUES = 1000
"""Values of a message; none of ours has half as many."""


def decode_finite_json(text: str, deepest: int = MAX_DEPTH) -> Any:
    """Return the decoded JSON; its numbers are finite.

    Raises:
        ValueError: not JSON, nested more than `deepest` levels, or with a number that is not
            finite.
    """
    try:
        value = _DECODER.decode(text)
    except RecursionError:
        raise ValueError("too deeply nested") from None
    # Most texts have too few brackets to be deep, and need no second look.
    if text.count("[") + text.count("{") > deepest and _is_deeper_than(deepest, value):
        raise ValueError("too deeply nested")
    if not _is_finite(value):
        # Only this way is it known which digits they are.
        json.loads(text, parse_float=_finite_float)
    return value


def decode_message(text: str) -> Any:
    """Return what a message's JSON holds: as `decode_finite_json`, but of few values.

    Python's decoder lets no other thread run before it is done. With more values the control loop
    would miss a tick for them.

    Raises:
        ValueError: as there, or more than `MAX_MESSAGE_VALUES` values.
    """
    if text.count(",") >= MAX_MESSAGE_VALUES:
        raise ValueError("too many values")
    return decode_finite_json(text)


def decode_message_object(text: str, what: str) -> dict[str, Any]:
    """Return the JSON object that a message holds; `what` names it in the sentence of the error.

    Raises:
        InputError: not JSON, not an object, too deeply nested, of too many values, or with a number
            that is not finite.
    """
    try:
        value = decode_message(text)
    except ValueError:
        value = None
    if not isinstance(value, dict):
        raise InputError(
            f"{what} must be one JSON object with finite numbers, of at most {MAX_MESSAGE_VALUES} "
            "values."
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
    """Return whether a decoded value is free of infinity, as which digits like 1e999 are decoded.

    To look at what is decoded takes far less time than to have the decoder call a function for each
    number.
    """
    values = [value]
    # It grows while it is looked through.
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
"""One for all: `json.loads` with arguments makes another each time."""
