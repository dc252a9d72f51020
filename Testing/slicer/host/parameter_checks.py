"""What may stand in an `Annotated` parameter."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Default:
    """The value that a new node has."""

    value: Any


@dataclass(frozen=True)
class WithinRange:
    """The value lies from `minimum` to `maximum`."""

    minimum: float
    maximum: float

    def check(self, value: float) -> None:
        if not self.minimum <= value <= self.maximum:
            raise ValueError(f"{value} is not within {self.minimum} to {self.maximum}.")


@dataclass(frozen=True)
class Choice:
    """The value is one of these."""

    choices: tuple

    def check(self, value: Any) -> None:
        if value not in self.choices:
            raise ValueError(f"{value!r} is none of {self.choices}.")
