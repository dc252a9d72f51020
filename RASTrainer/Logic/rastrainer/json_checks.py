"""Untrusted JSON: how it is decoded, and what a command, a record and a file's fields may hold.

Unlike Python's decoder, this one knows neither NaN nor infinity, and limits the depth. A check
returns the accepted value or raises `ValueError` with the words that follow "must be".
"""

from __future__ import annotations

import json
import math
import re
import sys
import uuid
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, TypeGuard, TypeVar

import numpy as np

from rastrainer.errors import InputError

MAX_DEPTH = 64
"""Nesting of lists and objects; the interpreter's own limit depends on its version."""
MAX_MESSAGE_VALUES = 1000
"""Most values in a message to the simulator; ours have less than half as many."""
MAX_RECORD_VALUES = 25_000
"""Most values in a message from the simulator: a trial's record, with a procedure at all of its
limits."""


def decode_finite_json(text: str, deepest: int = MAX_DEPTH) -> Any:
    """Return decoded JSON.

    Raise ValueError if it is not JSON, nested more than `deepest` levels, or a number is not
    finite.
    """
    try:
        value = _DECODER.decode(text)
    except RecursionError:
        raise ValueError("too deeply nested") from None
    depth, level = 0, [value]
    # A callback of the decoder for each number would be much slower.
    while level:
        below: list[Any] = []
        for each in level:
            kind = each.__class__
            if kind is float:
                if math.isinf(each):
                    raise ValueError("a number is too large")
            elif kind is list or kind is dict:
                if depth == deepest:
                    raise ValueError("too deeply nested")
                below += each if kind is list else each.values()
        depth, level = depth + 1, below
    return value


def _refuse_constant(word: str) -> float:
    raise ValueError(f"{word} is not a number")


_DECODER = json.JSONDecoder(parse_constant=_refuse_constant)
"""Shared, because `json.loads` with arguments makes a new one each time."""


def decode_message_object(text: str, what: str, most: int = MAX_MESSAGE_VALUES) -> dict[str, Any]:
    """Return the JSON object of a message of at most `most` values; `what` starts the error.

    Python's decoder blocks all other threads; with more values than `MAX_MESSAGE_VALUES`, the
    control loop would miss a tick.
    """
    try:
        value = decode_finite_json(text) if text.count(",") < most else None
    except ValueError:
        value = None
    if not isinstance(value, dict):
        raise InputError(
            f"{what} must be one JSON object with finite numbers, of at most {most} values."
        )
    return value


T = TypeVar("T")
OBJECT_LIMIT = 65_536
"""Characters of a JSON object that is kept with a trial, such as the details of a score."""
IDENTIFIER_WORDS = "lower-case letters, digits and hyphens"
_IDENTIFIER = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")


def is_identifier(name: str) -> bool:
    """Return whether a name is valid in commands and files: lower case, digits, hyphens."""
    return len(name) <= 40 and _IDENTIFIER.fullmatch(name) is not None


def identifier(value: Any) -> str:
    if not isinstance(value, str) or not is_identifier(value):
        raise ValueError(IDENTIFIER_WORDS)
    return value


def identifier_of(text: str) -> str:
    """Return the identifier made of a text; empty if it has no Latin letter or digit."""
    return re.sub(r"[^a-z0-9]+", "-", text.lower()).strip("-")[:40].strip("-")


def accepted(check: Callable[[Any], T], value: Any, what: str) -> T:
    try:
        return check(value)
    except InputError:
        raise
    except ValueError as error:
        raise InputError(f"{what} must be {error}.") from None


def is_number(value: object) -> TypeGuard[float]:
    """Return whether a decoded value is a number; true and false are none."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def check_of(
    is_valid: Callable[[Any], bool], words: str, make: Callable[[Any], T] = lambda value: value
) -> Callable[[Any], T]:
    """Return a check of a decoded value; `words` follow "must be", `make` gives the kept value."""

    def check(value: Any) -> T:
        if not is_valid(value):
            raise ValueError(words)
        return make(value)

    return check


def text(max_length: int = 64, min_length: int = 1) -> Callable[[Any], str]:
    """Accept printable text of `min_length` to `max_length` characters."""
    return check_of(
        lambda value: (
            isinstance(value, str)
            and value.isprintable()
            and min_length <= len(value) <= max_length
        ),
        f"printable text of {min_length} to {max_length} characters",
    )


def pseudonym(value: Any) -> str:
    if text()(value) != value.strip():
        raise ValueError("printable text without a space at its beginning or end")
    return value


def number(minimum: float, maximum: float, unit: str = "") -> Callable[[Any], float]:
    words = f"a number from {minimum:g} to {maximum:g} {unit}".rstrip()
    return check_of(lambda value: is_number(value) and minimum <= value <= maximum, words, float)


Setting = Annotated[float, number(-10_000, 10_000)]
"""No length, angle or speed is larger; with a larger one, a simulation would only never end."""


def whole_number(minimum: int, maximum: int) -> Callable[[Any], int]:
    words = f"a whole number from {minimum} to {maximum}"
    return check_of(
        lambda value: is_number(value) and isinstance(value, int) and minimum <= value <= maximum,
        words,
    )


def numbers(count: int, limit: float, unit: str = "") -> Callable[[Any], tuple[float, ...]]:
    return check_of(
        lambda value: (
            isinstance(value, (list, tuple))
            and len(value) == count
            and all(is_number(item) and -limit <= item <= limit for item in value)
        ),
        f"a list of {count} numbers within ±{limit:g} {unit}".rstrip(),
        lambda value: tuple(float(item) for item in value),
    )


def _array(values: tuple[float, ...], shape: tuple[int, ...]) -> np.ndarray:
    array = np.reshape(values, shape)
    array.setflags(write=False)
    return array


def point(limit: float) -> Callable[[Any], np.ndarray]:
    """Accept three numbers within ±`limit` mm: (3,) float, read-only."""
    check = numbers(3, limit, "mm")
    return lambda value: _array(check(value), (3,))


def transform(value: Any) -> np.ndarray:
    """Accept 16 numbers, row by row: (4, 4) float, read-only."""
    return _array(numbers(16, 1e6)(value), (4, 4))


@dataclass(frozen=True)
class SizeCheck:
    """A check of how many values a list or an object has; the values need another check."""

    check: Callable[[Any], Any]

    def __call__(self, value: Any) -> Any:
        return self.check(value)


def list_of(minimum: int = 0, maximum: int = sys.maxsize, what: str = "items") -> SizeCheck:

    def check(value: Any) -> tuple[Any, ...]:
        if not isinstance(value, (list, tuple)) or not minimum <= len(value) <= maximum:
            count = f"{minimum} to {maximum}" if minimum else f"at most {maximum}"
            raise ValueError("a list" if maximum == sys.maxsize else f"a list of {count} {what}")
        return tuple(value)

    return SizeCheck(check)


def object_of(
    maximum: int = sys.maxsize, check_name: Callable[[Any], str] | None = None
) -> SizeCheck:
    """Accept an object of at most `maximum` checked names with any values."""
    accept_name = check_name or text()

    def check(value: Any) -> dict[str, Any]:
        if not isinstance(value, Mapping) or len(value) > maximum:
            size = "" if maximum == sys.maxsize else f" of at most {maximum} names"
            raise ValueError(f"an object{size}")
        try:
            return {accept_name(name): item for name, item in value.items()}
        except ValueError as error:
            raise ValueError(f"an object, its names {error}") from None

    return SizeCheck(check)


def one_of(*choices: str) -> Callable[[Any], str]:
    words = "one of " + ", ".join(choices)
    return check_of(lambda value: isinstance(value, str) and value in choices, words)


def texts(
    min_count: int, max_count: int, choices: Collection[str] = ()
) -> Callable[[Any], tuple[str, ...]]:
    """Accept a list of different texts of up to 64 characters, of the choices if there are any."""
    check_one = text()

    def check(value: Any) -> tuple[str, ...]:
        sentence = f"a list of {min_count} to {max_count} texts"
        if not isinstance(value, list) or not min_count <= len(value) <= max_count:
            raise ValueError(sentence)
        try:
            found = tuple(check_one(item) for item in value)
        except ValueError:
            raise ValueError(sentence) from None
        if len(set(found)) != len(found):
            raise ValueError("a list without duplicates")
        if choices and not set(found) <= set(choices):
            raise ValueError(f"a list of some of {', '.join(choices)}")
        return found

    return check


yes_or_no: Callable[[Any], bool] = check_of(lambda value: isinstance(value, bool), "true or false")


def trial_id(value: Any) -> str:
    try:
        return str(uuid.UUID(value))
    except (ValueError, AttributeError, TypeError):
        raise ValueError("the UUID of a trial") from None


def plain_object(value: Any) -> dict[str, Any]:
    """Accept a JSON object as it is, within a size that fits a line of a journal."""
    words = f"a JSON object of at most {OBJECT_LIMIT} characters"
    try:
        size = len(json.dumps(value, allow_nan=False))
    except (TypeError, ValueError, RecursionError):
        raise ValueError(words) from None
    if not isinstance(value, dict) or size > OBJECT_LIMIT:
        raise ValueError(words)
    return value
