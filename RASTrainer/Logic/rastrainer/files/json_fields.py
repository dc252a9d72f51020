"""Untrusted JSON as fields, each with type and range, or as dataclasses; errors name the key."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar, cast

import numpy as np

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files.reading import printable_name, read_json

MAX_BYTES = 2**20
T = TypeVar("T")


class Fields:
    """The fields of a JSON object; a missing or invalid one raises `InputError`.

    The error names the file and the path of the field, such as `cameras.far.viewAngleDeg`.
    """

    def __init__(self, values: dict[str, Any], file: Path, path: str = "") -> None:
        self._values = values
        self._file = file
        self._path = path

    def names(self) -> tuple[str, ...]:
        return tuple(self._values)

    def check_names(self, known: Collection[str], what: str) -> None:
        """Raise `InputError` for a field that `what`, such as "a curriculum", does not have."""
        unknown = sorted(set(self._values) - set(known))
        if unknown:
            raise self.error(unknown[0][:40], f"left out; {what} has {', '.join(known)}")

    def with_defaults(self, defaults: Mapping[str, Any]) -> Fields:
        """Return the fields and, for those that are missing, defaults; also within objects."""
        values = {**defaults, **self._values}
        for name, inner in defaults.items():
            if isinstance(inner, Mapping) and isinstance(values[name], dict):
                values[name] = {**inner, **values[name]}
        return Fields(values, self._file, self._path)

    def check_format(self, version: int) -> None:
        """Raise `InputError` if `formatVersion` is not the version that is read."""
        if self.number("formatVersion", 0, 1e9) != version:
            raise self.error("formatVersion", f"{version}, which this version reads")

    def text(self, name: str, max_length: int = 200) -> str:
        return self._accepted(name, json_checks.text(max_length))

    def yes_or_no(self, name: str, default: bool) -> bool:
        """Return true or false; `default` where the field is missing."""
        return self._accepted(name, json_checks.yes_or_no) if name in self._values else default

    def number(self, name: str, minimum: float, maximum: float) -> float:
        return self._accepted(name, json_checks.number(minimum, maximum))

    def whole_number(self, name: str, minimum: int, maximum: int) -> int:
        """Return an integer from `minimum` to `maximum`, also if written as 3.0."""
        check = json_checks.whole_number(minimum, maximum)

        def check_whole(value: Any) -> int:
            is_whole = isinstance(value, float) and value.is_integer()
            return check(int(value) if is_whole else value)

        return self._accepted(name, check_whole)

    def one_of(self, name: str, choices: tuple[str, ...]) -> str:
        return self._accepted(name, json_checks.one_of(*choices))

    def texts(
        self, name: str, min_count: int, max_count: int, choices: tuple[str, ...] = ()
    ) -> tuple[str, ...]:
        """Return a list of different texts, each printable and, if given, one of the choices."""
        return self._accepted(name, json_checks.texts(min_count, max_count, choices))

    def numbers(self, name: str, count: int, limit: float) -> list[float]:
        return list(self._accepted(name, json_checks.numbers(count, limit)))

    def point(self, name: str, limit: float) -> np.ndarray:
        """Return a point, (3,) float, read-only, each coordinate within ±`limit`."""
        point = np.array(self.numbers(name, 3, limit), dtype=float)
        point.setflags(write=False)
        return point

    def identifier(self, name: str) -> str:
        """Return a name for commands and files: lower case, digits, hyphens."""
        value = self.text(name, 40)
        if not json_checks.is_identifier(value):
            raise self.error(name, json_checks.IDENTIFIER_WORDS)
        return value

    def fields(self, name: str) -> Fields:
        """Return the fields of an object."""
        value = self._values.get(name)
        if not isinstance(value, dict):
            raise self.error(name, "an object")
        return Fields(value, self._file, f"{self._path}{name}.")

    def list_of_fields(self, name: str, min_count: int, max_count: int) -> list[Fields]:
        """Return the fields of each object of a list of `min_count` to `max_count`."""
        values = self._values.get(name)
        if (
            not isinstance(values, list)
            or not min_count <= len(values) <= max_count
            or not all(isinstance(value, dict) for value in values)
        ):
            raise self.error(name, f"a list of {min_count} to {max_count} objects")
        paths = (f"{self._path}{name}[{index}]." for index in range(len(values)))
        return [Fields(v, self._file, path) for v, path in zip(values, paths, strict=True)]

    def file(self, name: str) -> Path:
        """Return a file in this file's folder or below; symbolic links are followed.

        It need not exist.
        """
        relative = self.text(name)
        folder = self._file.parent.resolve()
        path = (folder / relative).resolve()
        if "\\" in relative or not path.is_relative_to(folder) or path == folder:
            raise self.error(name, "the path of a file inside the scenario's folder")
        return path

    def error(self, name: str, wanted: str) -> InputError:
        return InputError(f"{self._field(name)} must be {wanted}.")

    def _accepted(self, name: str, check: Callable[[Any], T]) -> T:
        return json_checks.accepted(check, self._values.get(name), self._field(name))

    def _field(self, name: str) -> str:
        return f"{self._file}: the field {self._path}{name}"


def read_fields(path: Path) -> Fields:
    """Read a file with one JSON object."""
    values = read_json(path, MAX_BYTES)
    if not isinstance(values, dict):
        raise InputError(f"{path} must hold one JSON object.")
    return Fields(values, path)


def known_keys(value: Any, keys: Mapping[str, json_checks.Argument], what: str) -> dict[str, Any]:
    """Return an object's values as `json_checks.checked_keys` does, where it has no other keys.

    One that is misspelled must not be silently without effect.
    """
    checked = json_checks.checked_keys(value, keys, what)
    unknown = sorted(set(value) - set(keys))
    if unknown:
        raise InputError(
            f"{what}: there is no {printable_name(unknown[0])}; use {', '.join(keys)}."
        )
    return checked


def json_object(record: Any) -> dict[str, Any]:
    return {_camel_case(each.name): _plain(getattr(record, each.name)) for each in fields(record)}


def from_json_object(
    kind: type[T], value: object, checks: Mapping[str, json_checks.Argument], what: str
) -> T:
    """Return the dataclass that a decoded JSON object holds; unknown keys are ignored.

    Args:
        kind: the dataclass.
        value: the object, as of `json_object`.
        checks: how each key is checked.
        what: begins the sentence of an error.
    """
    names = {_camel_case(each.name): each.name for each in fields(cast("Any", kind))}
    checked = json_checks.checked_keys(value, {key: checks[key] for key in names}, what)
    return kind(**{names[key]: item for key, item in checked.items()})


def _camel_case(name: str) -> str:
    first, *others = name.split("_")
    return first + "".join(word.capitalize() for word in others)


def _plain(value: Any) -> Any:
    if hasattr(value, "to_json"):
        return value.to_json()
    if is_dataclass(value):
        return json_object(value)
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, Mapping):
        return dict(value)
    return [_plain(item) for item in value] if isinstance(value, (tuple, list)) else value
