"""What the operator does in one tick: the sticks, and the commands that arrived."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class OperatorCommand:
    """One command whose arguments `rastrainer.command_arguments.check_arguments` has accepted.

    `arguments` keep the names and units of the wire (mm); `ticket` is returned in the answer;
    `sender` names the client, for the state's `operator`.
    """

    name: str
    arguments: Mapping[str, Any] = field(default_factory=dict)
    ticket: int = 0
    sender: str = ""


@dataclass(frozen=True)
class OperatorInput:
    """The sticks' positions, −1…1 each, and the commands of one tick.

    `translation` is right, forward (into the picture) and up; `rotation` turns the tool's direction
    to the right and up, and counts only while the direction is steered. `fine` is the trigger for
    fine speed; `operator` names who holds the sticks.
    """

    translation: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: tuple[float, float] = (0.0, 0.0)
    fine: bool = False
    commands: tuple[OperatorCommand, ...] = ()
    operator: str = ""


HANDS_OFF = OperatorInput()
"""Nobody touches the sticks and no command has come."""
