"""What a simulator reveals of a trial once its registration is final."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer import protocol
from rastrainer.errors import InputError


@dataclass(frozen=True)
class RevealedTruth:
    """Where the head was.

    Attributes:
        head_to_world: 16 numbers, row by row, mm, from MRI RAS to World.
        true_tre_mm: how far the registration put the target from where it is.
    """

    head_to_world: tuple[float, ...]
    true_tre_mm: float

    @property
    def matrix(self) -> np.ndarray:
        """(4, 4) float, mm, from MRI RAS to World."""
        return np.reshape(self.head_to_world, (4, 4))

    @classmethod
    def from_json(cls, answer: Mapping[str, Any]) -> RevealedTruth:
        """Return what the answer to SubmitRegistration or GetTrial reveals.

        Raises:
            InputError: it reveals nothing, or not numbers.
        """
        try:
            return cls(
                protocol.numbers(16, 1e6)(answer.get("headToWorld")),
                protocol.number(0, 1e6)(answer.get("trueTreMm")),
            )
        except ValueError:
            raise InputError(
                "The simulator's answer must hold headToWorld, 16 numbers, and trueTreMm."
            ) from None
