"""Read a JSON file that nobody has checked yet: each field with its type, range and a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files import read_json

MOST_BYTES = 2**20


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
        value = self._values.get(name)
        if not isinstance(value, str) or not 1 <= len(value) <= longest or not value.isprintable():
            raise self.error(name, f"printable text of 1 to {longest} characters")
        return value

    def number(self, name: str, lowest: float, highest: float) -> float:
        """Return a finite number from `lowest` to `highest`."""
        value = self._values.get(name)
        if not _is_number(value) or not lowest <= value <= highest:
            raise self.error(name, f"a number from {lowest:g} to {highest:g}")
        return float(value)

    def whole_number(self, name: str, lowest: int, highest: int) -> int:
        """Return a whole number from `lowest` to `highest`."""
        value = self._values.get(name)
        if not _is_number(value) or value != int(value) or not lowest <= value <= highest:
            raise self.error(name, f"a whole number from {lowest} to {highest}")
        return int(value)

    def one_of(self, name: str, choices: tuple[str, ...]) -> str:
        """Return one of the given words."""
        value = self._values.get(name)
        if not isinstance(value, str) or value not in choices:
            raise self.error(name, f"one of {', '.join(choices)}")
        return value

    def texts(
        self, name: str, fewest: int, most: int, choices: tuple[str, ...] = ()
    ) -> tuple[str, ...]:
        """Return a list of different texts, each printable and, if given, one of the choices."""
        values = self._values.get(name)
        is_list = isinstance(values, list) and fewest <= len(values) <= most
        if not is_list or not all(_is_short_text(value) for value in values):
            raise self.error(name, f"a list of {fewest} to {most} texts")
        if len(set(values)) != len(values):
            raise self.error(name, "a list in which nothing stands twice")
        if choices and not set(values) <= set(choices):
            raise self.error(name, f"a list of some of {', '.join(choices)}")
        return tuple(values)

    def numbers(self, name: str, count: int, limit: float) -> list[float]:
        """Return a list of `count` finite numbers, each within ±`limit`."""
        values = self._values.get(name)
        if not isinstance(values, list) or len(values) != count:
            raise self.error(name, f"a list of {count} numbers")
        if not all(_is_number(value) and abs(value) <= limit for value in values):
            raise self.error(name, f"a list of {count} numbers within ±{limit:g}")
        return [float(value) for value in values]

    def fields(self, name: str) -> Fields:
        """Return an object's own fields."""
        value = self._values.get(name)
        if not isinstance(value, dict):
            raise self.error(name, "an object")
        return Fields(value, self._file, f"{self._path}{name}.")

    def list_of_fields(self, name: str, fewest: int, most: int) -> list[Fields]:
        """Return the fields of each object of a list of `fewest` to `most`."""
        values = self._values.get(name)
        is_list = isinstance(values, list) and fewest <= len(values) <= most
        if not is_list or not all(isinstance(value, dict) for value in values):
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
        return InputError(f"{self._file}: the field {self._path}{name} must be {wanted}.")


def read_fields(path: Path) -> Fields:
    """Read a file that holds one JSON object.

    Raises:
        InputError: missing, larger than 1 MiB, or not one JSON object with finite numbers.
    """
    values = read_json(path, MOST_BYTES)
    if not isinstance(values, dict):
        raise InputError(f"{path} must hold one JSON object.")
    return Fields(values, path)


def _is_short_text(value: Any) -> bool:
    return isinstance(value, str) and 1 <= len(value) <= 64 and value.isprintable()


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float)) and not isinstance(value, bool)
