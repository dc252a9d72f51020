"""Every setting of the simulation; a trial's journal records them."""

from __future__ import annotations

from dataclasses import dataclass, field

from rastrainer.json_checks import Setting
from rastrainer_simulator.collision.proximity import ProximitySettings
from rastrainer_simulator.robot.goal import FabrikSettings
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.teleoperation.teleoperation import TeleoperationSettings
from rastrainer_simulator.training.feed import ProcedureSettings
from rastrainer_simulator.training.rules import TrainingSettings


@dataclass(frozen=True)
class SimulationSettings:
    """How the simulation behaves; a trial starts `start_height` m above the head's target."""

    teleoperation: TeleoperationSettings = field(default_factory=TeleoperationSettings)
    fabrik: FabrikSettings = field(default_factory=FabrikSettings)
    training: TrainingSettings = field(default_factory=TrainingSettings)
    proximity: ProximitySettings = field(default_factory=ProximitySettings)
    start_height: Setting = 0.165
    axes: AxesChoice = AxesChoice.CAMERA
    camera: str = "close-up"
    procedure: ProcedureSettings = field(default_factory=ProcedureSettings)
