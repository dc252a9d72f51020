"""Records read from JSON by their annotations and written; all refuse hostile JSON."""

from __future__ import annotations

import contextlib
import functools
import importlib
import json
import math
import pkgutil
import re
import uuid
from dataclasses import is_dataclass
from typing import Any, get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rastrainer
import rastrainer_headless
import rastrainer_simulator
from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json
from rastrainer.json_records import RecordField, record_fields, record_from_json, record_to_json

EYE = [float(row == column) for row in range(4) for column in range(4)]
LIKELY = [
    *json.loads(
        """[0, 1, 0.5, true, "a", "a-b", "", [], {}, null, [0, 0, 1], [0, 0], ["a"], "#102030",
    0.01, [0, 0, 0, 0, 0, 0, 0], "2024-05-17T09:30:00Z", "https://example.org/a",
    "a.json", "no-go/a.ply", "de", "sus", ["desktop"], ["a", "b"], "0123456789ab", 15, 100, 1000]"""
    ),
    EYE,
    str(uuid.UUID(int=7)),
]
WRONG = [
    *json.loads(
        """[null, true, -1, 0, -1e308, 0.5, NaN, Infinity, "", "a", "\\u0000", "\\ud800", [], [[]],
    [null], [{}], ["a", "a"], [1e308, 1e308, 1e308], {}, {"": {}}, {"a": null}, {"a": [[]]},
    {"\\u0000": 1}]"""
    ),
    *(10**400, "x" * 5000, [math.nan] * 16, [True] * 16, list(range(3000))),
]


def modules():
    for package in (rastrainer, rastrainer_simulator, rastrainer_headless):
        yield package
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            # Slicer's own packages are not everywhere.
            try:
                yield importlib.import_module(found.name)
            except ImportError:
                continue


@functools.cache
def is_record(kind: type) -> bool:
    """Return whether the codec can read a dataclass: each of its fields has a check."""
    if not is_dataclass(kind):
        return False
    try:
        known = record_fields(kind)
    except (TypeError, NameError):
        return False
    parts = {part for each in known for part in parts_of(each.hint) if isinstance(part, type)}
    if not known or kind in parts:
        return False
    return all(is_record(part) for part in parts if is_dataclass(part))


def records() -> dict[str, type]:
    """Return all records of the product by name."""
    found = {
        value.__name__: value
        for module in modules()
        for value in vars(module).values()
        if isinstance(value, type) and value.__module__ == module.__name__ and is_record(value)
    }
    return dict(sorted(found.items()))


def parts_of(hint: Any):
    yield hint
    for part in get_args(hint):
        yield from parts_of(part)


def accepted_value(each: RecordField) -> Any:
    """Return decoded JSON that a field accepts."""
    candidates = [*LIKELY, *nested(each.hint)]
    for candidate in candidates:
        try:
            each.read(candidate, "It", False)
        except InputError as error:
            offered = offered_by(str(error))
            candidates += [offered] if offered not in (None, *candidates) else []
        else:
            return candidate
    raise AssertionError(f"no value for {each.key}: {each.hint}")


def offered_by(sentence: str) -> Any:
    """Return the first value that an error calls right; None without one."""
    if found := re.search(r"must be (?:one of|a list of some of) (.+?)(?:, .*)?\.$", sentence):
        with contextlib.suppress(ValueError):
            return json.loads(found[1])
        return found[1]
    if found := re.search(r"must be a (?:whole )?number (?:from|above) ([-.e\d]+)", sentence):
        return json.loads(found[1])
    if found := re.search(r"must be a list of (\d+) numbers", sentence):
        return [0.0] * int(found[1])
    return None


def nested(hint: Any) -> list[Any]:
    found = []
    for part in parts_of(hint):
        if isinstance(part, type) and is_dataclass(part):
            value = valid(part)
            found += [value, [value], [value] * 3, {"a": value}, {"close-up": value, "far": value}]
    return found


def valid(kind: type) -> dict[str, Any]:
    """Return an object whose values are accepted."""
    return {each.key: accepted_value(each) for each in record_fields(kind)}


def read_or_refuse(kind: type, value: Any) -> str:
    """Return the error or ""; an accepted value is written and reads the same."""
    try:
        record = record_from_json(kind, value, "It")
    except InputError as error:
        return str(error)
    written = json.loads(json.dumps(record_to_json(record), allow_nan=False))
    again = record_to_json(record_from_json(kind, written, "It"))
    assert json.loads(json.dumps(again)) == written
    return ""


KINDS = records()
FINITE = st.floats(allow_nan=False, allow_infinity=False)
"""The decoder knows no others."""
PLAIN = st.none() | st.booleans() | st.integers() | FINITE | st.text(max_size=70)
ANY_JSON = st.recursive(
    PLAIN,
    lambda inner: (
        st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=8), inner, max_size=4)
    ),
    max_leaves=8,
)


def test_each_wrong_value_and_missing_key_is_refused_by_an_error_that_names_it():
    assert {"TrialRecord", "AbortedTrial", "TouchedPoint", "TrialScore"} <= set(KINDS)
    for kind in KINDS.values():
        good = valid(kind)
        for each in record_fields(kind):
            for wrong in WRONG:
                error = read_or_refuse(kind, {**good, each.key: wrong})
                try:
                    each.read(wrong, "It", False)
                except InputError:
                    assert error.startswith(f"It: {each.key}"), (kind, each.key, wrong)
            error = read_or_refuse(kind, {key: good[key] for key in good if key != each.key})
            if each.default is None:
                assert error == f"It needs the key {json.dumps(each.key)}.", kind


@pytest.mark.parametrize("examples", [5, pytest.param(200, marks=pytest.mark.soak)])
@pytest.mark.parametrize("name", KINDS)
def test_any_json_and_any_bytes_make_a_record_or_an_error_for_people(name, examples):
    kind = KINDS[name]
    good = valid(kind)
    text = json.dumps(good).encode()

    @settings(max_examples=examples)
    @given(ANY_JSON | st.fixed_dictionaries({}, optional=dict.fromkeys(good, ANY_JSON)))
    def of_any_json(value):
        read_or_refuse(kind, {**good, **value} if isinstance(value, dict) else value)

    @settings(max_examples=examples)
    @given(st.integers(0, len(text)), st.integers(0, 8), st.binary(max_size=8))
    def of_any_bytes(start, length, other):
        damaged = text[:start] + other + text[start + length :]
        try:
            value = decode_finite_json(damaged.decode())
        except ValueError:
            return
        read_or_refuse(kind, value)

    of_any_json()
    of_any_bytes()
