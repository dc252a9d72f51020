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
from collections.abc import Mapping
from dataclasses import dataclass, field, is_dataclass
from enum import Enum
from typing import Annotated, Any, Literal, get_args

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import rastrainer
import rastrainer_headless
import rastrainer_simulator
from rastrainer.errors import InputError
from rastrainer.json_checks import (
    decode_finite_json,
    list_of,
    number,
    numbers,
    object_of,
    one_of,
    point,
    text,
    texts,
    whole_number,
)
from rastrainer.json_records import (
    RecordField,
    camel_case,
    record_fields,
    record_from_json,
    record_to_json,
)


class Color(str, Enum):
    RED = "red"
    DARK_BLUE = "dark blue"


Length = Annotated[float, number(0, 100, "mm")]


@dataclass(frozen=True)
class Place:
    label: str
    position_mm: Annotated[tuple[float, float, float], numbers(3, 500, "mm")]
    depth_mm: Length | None = None


@dataclass(frozen=True, eq=False)
class Everything:
    """Every kind of field; the least is less than the most."""

    name: Annotated[str, text(5)]
    is_new: bool
    color: Color
    side: Literal["left", "right"]
    least: Annotated[int, whole_number(0, 9)]
    most: Annotated[int, whole_number(0, 9)]
    first: Place
    center_ras: Annotated[np.ndarray, point(300)]
    places: Annotated[tuple[Place, ...], list_of(0, 2, "places")] = ()
    lengths_mm: tuple[Length, ...] = ()
    tags: Annotated[tuple[str, ...], texts(0, 2)] = ()
    cameras: Mapping[str, Place] = field(default_factory=dict)
    times_s: Annotated[Mapping[str, Length], object_of(2, one_of("a", "b"))] = field(
        default_factory=dict
    )
    last: Place | None = None
    colors: tuple[Color, ...] = (Color.RED,)

    def __post_init__(self) -> None:
        if self.least > self.most:
            raise InputError("The least must not be above the most.")


PLACE = {"label": "1", "positionMm": [1, 2, 3]}
LEAST = {
    "name": "abc",
    "isNew": True,
    "color": "dark blue",
    "side": "left",
    "least": 1,
    "most": 2,
    "first": PLACE,
    "centerRas": [0, 0, 5],
}
MOST = {
    **LEAST,
    "places": [PLACE, {**PLACE, "depthMm": 4.5}],
    "lengthsMm": [1.0, 2.5],
    "tags": ["x", "y"],
    "cameras": {"far": PLACE},
    "timesS": {"a": 3.0},
    "last": PLACE,
    "colors": ["red", "dark blue"],
}


def read(value: object, only_known: bool = False) -> Everything:
    return record_from_json(Everything, value, "The thing", only_known)


def test_each_kind_of_field_is_read():
    thing = read(MOST)
    assert (thing.name, thing.is_new, thing.least, thing.most) == ("abc", True, 1, 2)
    assert (thing.color, thing.side) == (Color.DARK_BLUE, "left")
    assert thing.first == thing.last == thing.cameras["far"] == Place("1", (1.0, 2.0, 3.0))
    assert thing.places == (thing.first, Place("1", (1.0, 2.0, 3.0), 4.5))
    assert thing.lengths_mm == (1.0, 2.5)
    assert thing.tags == ("x", "y")
    assert thing.times_s == {"a": 3.0}
    assert thing.colors == (Color.RED, Color.DARK_BLUE)


def test_a_point_is_a_read_only_array():
    center = read(LEAST).center_ras
    assert center.tolist() == [0.0, 0.0, 5.0]
    with pytest.raises(ValueError, match="read-only"):
        center[0] = 1.0


def test_fields_at_their_default_are_left_out_unless_they_are_asked_for():
    assert set(record_to_json(read(LEAST))) == set(LEAST)
    full = record_to_json(read(LEAST), with_defaults=True)
    assert list(full) == [each.key for each in record_fields(Everything)]
    assert (full["colors"], full["last"], full["first"]["depthMm"]) == (["red"], None, None)


@pytest.mark.parametrize(
    ("key", "wrong", "sentence"),
    [
        ("name", "abcdef", "name must be printable text of 1 to 5 characters."),
        ("isNew", 1, "isNew must be true or false."),
        ("color", "green", "color must be one of red, dark blue."),
        ("color", ["red"], "color must be one of red, dark blue."),
        ("side", None, "side must be one of left, right."),
        ("least", True, "least must be a whole number from 0 to 9."),
        ("first", [], "first must be a JSON object."),
        ("first", {}, 'first needs the key "label".'),
        (
            "first",
            {**PLACE, "positionMm": [1, 2]},
            "first.positionMm must be a list of 3 numbers within ±500 mm.",
        ),
        ("centerRas", [1, 2, "3"], "centerRas must be a list of 3 numbers within ±300 mm."),
        ("places", [PLACE] * 3, "places must be a list of at most 2 places."),
        (
            "places",
            [PLACE, {**PLACE, "depthMm": -1}],
            "places[1].depthMm must be a number from 0 to 100 mm.",
        ),
        ("places", {}, "places must be a list of at most 2 places."),
        ("lengthsMm", "1", "lengthsMm must be a list."),
        ("lengthsMm", [1, None], "lengthsMm[1] must be a number from 0 to 100 mm."),
        ("tags", ["x", "x"], "tags must be a list without duplicates."),
        ("cameras", [], "cameras must be an object."),
        ("cameras", {"": PLACE}, "cameras must be an object, its names printable text of 1 to "),
        ("cameras", {"far": {**PLACE, "label": 3}}, "cameras.far.label must be printable text of "),
        ("timesS", {"c": 1}, "timesS must be an object, its names one of a, b."),
        ("timesS", {"a": 1, "b": 1, "c": 1}, "timesS must be an object of at most 2 names."),
        ("timesS", {"b": 101}, "timesS.b must be a number from 0 to 100 mm."),
        ("colors", ["red", "pink"], "colors[1] must be one of red, dark blue."),
    ],
)
def test_an_error_names_the_record_the_key_and_its_place(key, wrong, sentence):
    with pytest.raises(InputError) as error:
        read({**MOST, key: wrong})
    assert str(error.value).startswith(f"The thing: {sentence}")


@pytest.mark.parametrize("value", [None, 3, "{}", [], [LEAST]])
def test_what_is_no_object_is_refused(value):
    with pytest.raises(InputError, match=r"^The thing must be a JSON object\.$"):
        read(value)


def test_a_rule_of_several_fields_is_checked():
    with pytest.raises(InputError, match="least must not be above the most"):
        read({**LEAST, "least": 3})


def test_unknown_keys_are_ignored_except_in_files_that_people_write():
    value = {**LEAST, "neu": 1, "first": {**PLACE, "lable": "2"}}
    assert read(value).first.label == "1"
    with pytest.raises(InputError, match=r'^The thing: there is no "neu"; use name, isNew, '):
        read(value, only_known=True)
    del value["neu"]
    with pytest.raises(InputError, match=r'^The thing: first: there is no "lable"; use label, '):
        read(value, only_known=True)


def test_an_error_begins_with_the_words_of_the_record_where_nothing_else_is_said():
    with pytest.raises(InputError, match=r"^The everything: name must be"):
        record_from_json(Everything, {**LEAST, "name": 5})


def test_a_unit_ends_the_key():
    assert camel_case("sim_time_s") == "simTimeS"
    assert camel_case("center_ras") == "centerRas"


@pytest.mark.parametrize(
    "kind",
    [
        float,
        dict,
        Any,
        tuple[float, ...],
        Annotated[tuple[float, ...], list_of(0, 3)],
        Annotated[Mapping[str, int], object_of(3)],
    ],
)
def test_a_field_without_a_check_is_a_mistake_of_the_developer(kind):
    @dataclass
    class Unchecked:
        size: object

    Unchecked.__annotations__["size"] = kind
    with pytest.raises(TypeError, match=r"Unchecked\.size: .* needs a check"):
        record_fields(Unchecked)


def test_what_is_only_written_needs_no_check():
    @dataclass
    class Written:
        size_mm: float
        matrix: np.ndarray

    value = {"sizeMm": 1.5, "matrix": [1.0, 2.0, 3.0, 4.0]}
    assert record_to_json(Written(1.5, np.array([[1.0, 2.0], [3.0, 4.0]]))) == value


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
    """Return the first value that an error says is right, None without one."""
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
    """Return an object each of whose keys is accepted."""
    return {each.key: accepted_value(each) for each in record_fields(kind)}


def read_or_refuse(kind: type, value: Any) -> str:
    """Return the error, "" without one; what is accepted is written and reads the same."""
    try:
        record = record_from_json(kind, value, "It")
    except InputError as error:
        return str(error)
    written = json.loads(json.dumps(record_to_json(record), allow_nan=False))
    again = record_to_json(record_from_json(kind, written, "It"))
    assert json.loads(json.dumps(again)) == written
    return ""


KINDS = records()
PLAIN = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=70)
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


@pytest.mark.parametrize("examples", [10, pytest.param(1000, marks=pytest.mark.soak)])
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
