"""Records as JSON: annotated dataclasses, read from untrusted JSON and written.

A field's annotation holds its check, and its key is its name in camel case:

    @dataclass(frozen=True)
    class TouchedPoint:
        label: str
        position_mm: Annotated[tuple[float, float, float], numbers(3, WORLD_LIMIT_MM, "mm")]
        sim_time_s: Annotated[float, number(0, TIME_LIMIT_S, "s")]

A plain `str` is a text of `json_checks.text()`. `bool`, enums, `Literal`, other records, and of
these `X | None`, `tuple[X, ...]` and `Mapping[str, X]` need no check; all else does. A check sees
the decoded JSON, and limits the length of lists and objects (`list_of`, `object_of`); the value is
made from its result. For rules of several fields, `__post_init__` raises `InputError`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Mapping
from dataclasses import MISSING, dataclass, fields, is_dataclass
from enum import Enum
from functools import cache
from pathlib import PurePath
from typing import Annotated, Any, Literal, TypeVar, cast, get_args, get_origin, get_type_hints

import numpy as np

from rastrainer import json_checks
from rastrainer.errors import InputError

T = TypeVar("T")
NOT_IN_JSON = {"json": False}
"""Metadata of a field that the program fills in; it needs a default."""
Reader = Callable[[Any, str, bool], Any]
"""Makes a field's value of decoded JSON, its place for errors, and `only_known`."""


@dataclass(frozen=True)
class RecordField:
    """One field of a record; the key is required where `default` is None."""

    name: str
    key: str
    hint: Any
    read: Reader
    default: Callable[[], Any] | None


def record_from_json(
    kind: type[T], value: object, what: str = "", only_known: bool = False, is_part: bool = False
) -> T:
    """Return the record of a dataclass `kind` that a decoded JSON object holds.

    `what` begins the sentence of an error; without it, "The trial record" of a `TrialRecord`.
    `only_known` refuses unknown keys, as in files that people write: a misspelled one must not be
    without effect. `is_part` says that `what` is a place in a larger record.
    """
    what = what or "The" + re.sub("[A-Z]", lambda each: f" {each[0].lower()}", kind.__name__)
    before_key = f"{what}." if is_part else f"{what}: "
    if not isinstance(value, Mapping):
        raise InputError(f"{what} must be a JSON object.")
    known = record_fields(cast("Any", kind))
    keys = [each.key for each in known]
    if only_known and (unknown := sorted(str(key) for key in value if key not in keys)):
        raise InputError(
            f"{what}: there is no {json.dumps(unknown[0][:40])}; use {', '.join(keys)}."
        )
    values = {}
    for each in known:
        if each.key in value:
            values[each.name] = each.read(value[each.key], f"{before_key}{each.key}", only_known)
        elif each.default is None:
            raise InputError(f"{what} needs the key {json.dumps(each.key)}.")
    return kind(**values)


def record_to_json(record: Any, with_defaults: bool = False) -> dict[str, Any]:
    """Return the JSON object that `record_from_json` reads.

    Fields that hold their default are left out, unless `with_defaults`.
    """
    values = {}
    for name, key, default in _keys(cast("Any", type(record))):
        value = getattr(record, name)
        if with_defaults or default is None or not _are_equal(value, default()):
            values[key] = _plain(value, with_defaults)
    return values


@cache
def record_fields(kind: Any) -> tuple[RecordField, ...]:
    """Return the fields that a dataclass has in JSON, in their order."""
    hint = get_type_hints(kind, include_extras=True)
    return tuple(
        RecordField(name, key, hint[name], _reader(hint[name], f"{kind.__name__}.{name}"), default)
        for name, key, default in _keys(kind)
    )


@cache
def _keys(kind: Any) -> tuple[tuple[str, str, Callable[[], Any] | None], ...]:
    return tuple(
        (x.name, camel_case(x.name), _default(x))
        for x in fields(kind)
        if x.init and x.metadata != NOT_IN_JSON
    )


def camel_case(name: str) -> str:
    first, *others = name.split("_")
    return first + "".join(word[:1].upper() + word[1:] for word in others)


def _default(each: Any) -> Callable[[], Any] | None:
    if each.default is not MISSING:
        return lambda: each.default
    return None if each.default_factory is MISSING else each.default_factory


def _reader(hint: Any, name: str) -> Reader:
    """Return what reads values of an annotation; `name` is the field's, for developers."""
    kind, checks = _kind_and_checks(hint)
    is_optional = type(None) in get_args(kind)
    if is_optional:
        kind, more = _kind_and_checks(next(x for x in get_args(kind) if x is not type(None)))
        checks += more
    build = _builder(kind, name)
    if build is None and all(isinstance(check, json_checks.SizeCheck) for check in checks):
        if kind not in _CHECKS:
            raise TypeError(f"{name}: {kind} needs a check.")
        checks = [*checks, _CHECKS[kind]]

    def read(value: Any, place: str, only_known: bool) -> Any:
        if value is None and is_optional:
            return None
        for check in checks:
            value = json_checks.accepted(check, value, place)
        return build(value, place, only_known) if build else value

    return read


_CHECKS: dict[Any, Callable[[Any], Any]] = {str: json_checks.text(), bool: json_checks.yes_or_no}


def _kind_and_checks(hint: Any) -> tuple[Any, list[Callable[[Any], Any]]]:
    kind, *marks = get_args(hint) if get_origin(hint) is Annotated else (hint,)
    return kind, [mark for mark in marks if callable(mark)]


def _builder(kind: Any, name: str) -> Reader | None:
    """Return the reader of a type's values; None if the accepted value is the value itself."""
    origin, parts = get_origin(kind), get_args(kind)
    if isinstance(kind, type) and is_dataclass(kind):
        return lambda value, place, only_known: (
            value
            if isinstance(value, kind)
            else record_from_json(kind, value, place, only_known, is_part=True)
        )
    if origin is Literal or (isinstance(kind, type) and issubclass(kind, Enum)):
        choose = json_checks.one_of(*(parts or (str(each.value) for each in kind)))
        make = (lambda word: word) if origin is Literal else kind
        return lambda value, place, _: make(json_checks.accepted(choose, value, place))
    is_tuple = origin is tuple and parts[1:] == (...,)
    if not is_tuple and origin is not Mapping:
        return None
    item = parts[0] if is_tuple else parts[1]
    if not (item in _CHECKS or get_origin(item) is Annotated or _builder(item, name)):
        return None
    read_item = _reader(item, name)

    def read_list(value: Any, place: str, only_known: bool) -> tuple[Any, ...]:
        items = enumerate(json_checks.accepted(json_checks.list_of(), value, place))
        return tuple(read_item(item, f"{place}[{index}]", only_known) for index, item in items)

    def read_object(value: Any, place: str, only_known: bool) -> dict[str, Any]:
        items = json_checks.accepted(json_checks.object_of(), value, place).items()
        return {key: read_item(item, f"{place}.{key}", only_known) for key, item in items}

    return read_list if is_tuple else read_object


def _plain(value: Any, with_defaults: bool) -> Any:
    if value.__class__ in (float, int, str):
        return value
    if is_dataclass(value):
        return record_to_json(value, with_defaults)
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, PurePath):
        return value.as_posix()
    if isinstance(value, np.ndarray):
        return value.ravel().tolist()
    if isinstance(value, Mapping):
        return {str(key): _plain(item, with_defaults) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [_plain(item, with_defaults) for item in value]
    return value


def _are_equal(value: Any, default: Any) -> bool:
    if isinstance(value, np.ndarray):
        return np.array_equal(value, default)
    return value is default or (type(value) is type(default) and value == default)
