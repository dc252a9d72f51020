"""Every setting of the simulation, and how it is written into a journal and read back."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from enum import Enum
from typing import Any, TypeVar, get_type_hints

from rastrainer.errors import InputError
from rastrainer.json_checks import is_number
from rastrainer_simulator.collision.proximity import ProximitySettings
from rastrainer_simulator.robot.goal import FabrikSettings
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.teleoperation.teleoperation import TeleoperationSettings
from rastrainer_simulator.training.feed import ProcedureSettings
from rastrainer_simulator.training.rules import TrainingSettings

T = TypeVar("T")

LARGEST_NUMBER = 10_000
"""No length, angle, speed or count of iterations is larger; a larger one would only never end."""


@dataclasses.dataclass(frozen=True)
class SimulationSettings:
    """How the simulation behaves.

    Attributes:
        teleoperation: how the arm answers to the operator.
        fabrik: tolerances and the most iterations of the inverse kinematics.
        training: what counts as a touch.
        proximity: where proximity and contact start and end.
        start_height: of the tip above the head's target when a trial starts, m.
        axes: whose right, forward and up the sticks follow.
        camera: the view at the start.
        procedure: how a procedure is carried out.
    """

    teleoperation: TeleoperationSettings = dataclasses.field(default_factory=TeleoperationSettings)
    fabrik: FabrikSettings = dataclasses.field(default_factory=FabrikSettings)
    training: TrainingSettings = dataclasses.field(default_factory=TrainingSettings)
    proximity: ProximitySettings = dataclasses.field(default_factory=ProximitySettings)
    start_height: float = 0.165
    axes: AxesChoice = AxesChoice.CAMERA
    camera: str = "close-up"
    procedure: ProcedureSettings = dataclasses.field(default_factory=ProcedureSettings)


def settings_to_json(settings: Any) -> dict[str, Any]:
    """Return a dataclass of settings as a JSON object, nested like the dataclass."""
    return {
        field.name: _to_json(getattr(settings, field.name))
        for field in dataclasses.fields(settings)
    }


def settings_from_json(kind: type[T], value: Mapping[str, Any]) -> T:
    """Return the settings that a JSON object holds; what it lacks keeps its default."""
    hints = get_type_hints(kind)
    unknown = set(value) - set(hints)
    if unknown:
        raise InputError(f"The settings have no {', '.join(sorted(unknown))}.")
    return kind(**{name: _from_json(hints[name], name, value[name]) for name in value})


def _to_json(value: Any) -> Any:
    if dataclasses.is_dataclass(value):
        return settings_to_json(value)
    return value.value if isinstance(value, Enum) else value


def _from_json(kind: Any, name: str, value: Any) -> Any:
    if isinstance(kind, type) and dataclasses.is_dataclass(kind) and isinstance(value, Mapping):
        return settings_from_json(kind, value)
    try:
        if kind in (int, float) and not _is_reasonable(value):
            raise ValueError
        if isinstance(value, (list, Mapping)) or (kind is bool) is not isinstance(value, bool):
            raise TypeError
        return kind(value)
    except (TypeError, ValueError):
        raise InputError(f"The setting {name} cannot be {str(value)[:40]!r}.") from None


def _is_reasonable(value: Any) -> bool:
    return is_number(value) and abs(value) <= LARGEST_NUMBER
