"""What was touched, and how it was registered: values of the trial's state, in m and s."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer_simulator.vectors import Vector

SAME = 1e-9
"""Registrations are the same up to this part of a number, and up to as many mm."""


@dataclass(frozen=True)
class TouchState:
    """One touched fiducial: where the tip was (World, m) and when.

    `elapsed` is the trial's time in s, pauses excluded.
    """

    label: str
    position: Vector
    sim_time: float
    elapsed: float


@dataclass(frozen=True)
class FinalRegistration:
    """A registration by its numbers: one in use, or the one that was submitted for a trial (mm).

    `matrix` is WorldToHead, 16 floats row by row, mm.
    """

    matrix: tuple[float, ...]
    fre_mm: float
    expected_tre_mm: float

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> FinalRegistration:
        """Return what the arguments of UseRegistration or SubmitRegistration hold."""
        return cls(tuple(arguments["matrix"]), arguments["freMm"], arguments["expectedTreMm"])

    def agrees_with(self, other: FinalRegistration) -> bool:
        """Return whether both are the outcome of one computation.

        Slicer's numpy and the simulator's may round the last digits otherwise; who knows the truth
        gains nothing from so little.
        """
        pairs = zip(self._numbers(), other._numbers(), strict=True)
        return all(math.isclose(a, b, rel_tol=SAME, abs_tol=SAME) for a, b in pairs)

    def _numbers(self) -> tuple[float, ...]:
        return (*self.matrix, self.fre_mm, self.expected_tre_mm)


@dataclass(frozen=True)
class CheckedPoint:
    """A checkpoint as it was touched.

    Attributes:
        name: of the checkpoint.
        position: of the tip, World, m.
        error: its distance to the checkpoint by the registration in use, m.
        sim_time: s.
        elapsed: the trial's time in s, pauses excluded.
    """

    name: str
    position: Vector
    error: float
    sim_time: float
    elapsed: float


@dataclass(frozen=True)
class RegistrationAttempt:
    """One round of touching, registering and checking.

    Attributes:
        touches: that were registered.
        registration: that was used; None where the trainee touched again before there was one.
        checkpoints: that were touched by it.
    """

    touches: tuple[TouchState, ...]
    registration: FinalRegistration | None
    checkpoints: tuple[CheckedPoint, ...]
