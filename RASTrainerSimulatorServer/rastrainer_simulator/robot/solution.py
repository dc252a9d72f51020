"""What FABRIK is asked to achieve, and what it answers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from rastrainer.errors import InputError

OUT_OF_REACH = "The target is out of reach; the tool is as near to it as the arm gets."
ROLL_BLOCKED = (
    "The joint limits do not allow this roll of the tool there; it is as near as it gets."
)
BLOCKED = "No posture inside the joint limits holds the tool like that; the arm stays where it is."


@dataclass(frozen=True)
class FabrikSettings:
    """When a solution is good enough, and when the passes give up."""

    tolerance_m: float = 1e-9
    tolerance_rad: float = 1e-8
    max_iterations: int = 32

    def __post_init__(self) -> None:
        """Raise InputError for settings that could never end or never succeed."""
        if not (self.tolerance_m > 0.0 and self.tolerance_rad > 0.0 and self.max_iterations >= 1):
            raise InputError("FABRIK needs tolerances above zero and at least one iteration.")

    def met(self, position_error_m: float, direction_error_rad: float) -> bool:
        """Tell whether errors are within tolerance."""
        return position_error_m <= self.tolerance_m and direction_error_rad <= self.tolerance_rad


class Solution(NamedTuple):
    """Joint angles (rad) inside the limits, and how far from the target they hold the tool.

    `direction_error_rad` is the angle between the tool's directions, or of the rotation between the
    poses where a rotation was asked for, or 0. `reason` is a sentence for the operator, empty where
    the target is met.
    """

    q: tuple[float, ...]
    position_error_m: float
    direction_error_rad: float
    converged: bool
    iterations: int
    reason: str
