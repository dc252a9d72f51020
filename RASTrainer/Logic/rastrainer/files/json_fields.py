"""Read a JSON file that nobody has checked yet: each field with its type, range and a sentence."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files.reading import read_json

MAX_BYTES = 2**20
T = TypeVar("T")


class Fields:
    """The fields of a JSON object; what is missing or wrong raises `InputError`.

    Sentences name the file and the field by its path, such as `cameras.far.viewAngleDeg`.
    """

    def __init__(self, values: dict[str, Any], file: Path, path: str = "") -> None:
        self._values = values
        self._file = file
        self._path = path

    def names(self) -> tuple[str, ...]:
        """Return the names of all fields, in their order."""
        return tuple(self._values)

    def text(self, name: str, longest: int = 200) -> str:
        """Return printable text of 1 to `longest` characters."""
        return self._accepted(name, json_checks.text(longest))

    def number(self, name: str, lowest: float, highest: float) -> float:
        """Return a finite number from `lowest` to `highest`."""
        return self._accepted(name, json_checks.number(lowest, highest))

    def whole_number(self, name: str, lowest: int, highest: int) -> int:
        """Return a whole number from `lowest` to `highest`, which may be written as 3.0."""
        check = json_checks.whole_number(lowest, highest)

        def check_whole(value: Any) -> int:
            is_whole = isinstance(value, float) and value.is_integer()
            return check(int(value) if is_whole else value)

        return self._accepted(name, check_whole)

    def one_of(self, name: str, choices: tuple[str, ...]) -> str:
        """Return one of the given words."""
        return self._accepted(name, json_checks.one_of(*choices))

    def texts(
        self, name: str, fewest: int, most: int, choices: tuple[str, ...] = ()
    ) -> tuple[str, ...]:
        """Return a list of different texts, each printable and, if given, one of the choices."""
        return self._accepted(name, json_checks.texts(fewest, most, choices))

    def numbers(self, name: str, count: int, limit: float) -> list[float]:
        """Return a list of `count` finite numbers, each within ±`limit`."""
        return list(self._accepted(name, json_checks.numbers(count, limit)))

    def fields(self, name: str) -> Fields:
        """Return an object's own fields."""
        value = self._values.get(name)
        if not isinstance(value, dict):
            raise self.error(name, "an object")
        return Fields(value, self._file, f"{self._path}{name}.")

    def list_of_fields(self, name: str, fewest: int, most: int) -> list[Fields]:
        """Return the fields of each object of a list of `fewest` to `most`."""
        values = self._values.get(name)
        if (
            not isinstance(values, list)
            or not fewest <= len(values) <= most
            or not all(isinstance(value, dict) for value in values)
        ):
            raise self.error(name, f"a list of {fewest} to {most} objects")
        paths = (f"{self._path}{name}[{index}]." for index in range(len(values)))
        return [Fields(v, self._file, path) for v, path in zip(values, paths, strict=True)]

    def file(self, name: str) -> Path:
        """Return a file that lies in this file's folder or below it; symbolic links are followed.

        It need not exist: who reads it says so.
        """
        relative = self.text(name)
        folder = self._file.parent.resolve()
        path = (folder / relative).resolve()
        if "\\" in relative or not path.is_relative_to(folder) or path == folder:
            raise self.error(name, "the path of a file inside the scenario's folder")
        return path

    def error(self, name: str, wanted: str) -> InputError:
        """Return the error that says what a field must be."""
        return InputError(f"{self._field(name)} must be {wanted}.")

    def _accepted(self, name: str, check: Callable[[Any], T]) -> T:
        return json_checks.accepted(check, self._values.get(name), self._field(name))

    def _field(self, name: str) -> str:
        return f"{self._file}: the field {self._path}{name}"


def read_fields(path: Path) -> Fields:
    """Read a file that holds one JSON object.

    Raises:
        InputError: missing, larger than 1 MiB, or not one JSON object with finite numbers.
    """
    values = read_json(path, MAX_BYTES)
    if not isinstance(values, dict):
        raise InputError(f"{path} must hold one JSON object.")
    return Fields(values, path)
