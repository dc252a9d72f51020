"""A procedure that virtual hands carry out by a registration, for cohorts: errors without physics.

The touches are played with the whole simulation; what follows is drawn. The guide misses the line
that the registration shows, the drill stops past the true inner table, the instrument misses its
depth. Scatter and pace of the hands are in proportion to the touches.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.geometry import bone_ahead
from rastrainer.procedure.plan import Checkpoint, Procedure, ProcedureTrajectory
from rastrainer.procedure.record import (
    DEPTH_LIMIT_MM,
    PlacedInstrument,
    ProcedureRecord,
    RecordedAttempt,
    TouchedCheckpoint,
    UsedRegistration,
)
from rastrainer.protocol import Phase
from rastrainer.trial.procedure_outcome import (
    ALIGNING_S,
    DRILLING_S,
    HANDLING_S,
    INSERTION_MM_S,
    STAND_OFF_MM,
    VERIFYING_S,
)
from rastrainer_simulator.vectors import vector
from rastrainer_simulator.virtual.hand import Skill

MISSED_BONE_MM = 20.0
"""How far the drill goes past the entry where it meets no bone."""
MAX_CHECKPOINTS = 3
TIME_SD = 0.15
"""Standard deviation of the logarithm of the times of aligning, drilling and inserting."""


@dataclass(frozen=True)
class ProcedureHands:
    """How exactly hands carry out a procedure; our own convention.

    Standard deviations are of the guide's axis at the entry along each of two axes, of its
    direction about each of two axes, of the depth, and of the touch of a checkpoint along each of
    three axes. `plunge_mm` is the mean of how far the drill goes past the inner table
    (exponential); `pace` divides the times of the score's reference.
    """

    entry_sd_mm: float = 0.4
    angle_sd_deg: float = 0.5
    depth_sd_mm: float = 0.6
    plunge_mm: float = 0.7
    check_sd_mm: float = Skill.aim_sd_mm
    pace: float = 1.0

    @classmethod
    def of(cls, skill: Skill) -> ProcedureHands:
        """Return hands with the scatter and pace of a skill, in proportion to the typical skill."""
        typical, usual = Skill(), cls()
        scatter = skill.aim_sd_mm / typical.aim_sd_mm
        return cls(
            scatter * usual.entry_sd_mm,
            scatter * usual.angle_sd_deg,
            scatter * usual.depth_sd_mm,
            scatter * usual.plunge_mm,
            skill.aim_sd_mm,
            skill.speed_mm_s / typical.speed_mm_s,
        )


@dataclass(frozen=True, eq=False)
class VirtualProcedure:
    """A procedure on a skull of known SHA-256, after a registration; the true pose is in mm."""

    procedure: Procedure
    skull: HeadMesh
    sha256: str
    head_to_world: np.ndarray
    used: UsedRegistration
    touching_s: float
    hands: ProcedureHands
    random: np.random.Generator

    def carried_out(self) -> ProcedureRecord:
        """Return the record of what the hands did; it draws from `random`."""
        instruments = tuple(map(self._placed, self.procedure.trajectories))
        verifying_s = VERIFYING_S / self.hands.pace * self._spread()
        each_s = sum(sum(one.times_s.values()) for one in instruments)
        checkpoints = tuple(
            self._checked(number, checkpoint)
            for number, checkpoint in enumerate(self.procedure.checkpoints[:MAX_CHECKPOINTS], 1)
        )
        phases = (Phase.ALIGNING.value, Phase.DRILLING.value, Phase.INSERTING.value)
        return ProcedureRecord(
            procedure=self.procedure.name,
            kind=self.procedure.kind,
            sha256=self.sha256,
            duration_s=self.touching_s + verifying_s + each_s,
            attempts=(RecordedAttempt((), self.used, checkpoints),),
            instruments=instruments,
            phase_times_s={
                Phase.RUNNING.value: self.touching_s,
                Phase.VERIFYING.value: verifying_s,
                **{phase: sum(one.times_s[phase] for one in instruments) for phase in phases},
            },
        )

    def _placed(self, plan: ProcedureTrajectory) -> PlacedInstrument:
        hands, random = self.hands, self.random
        to_world = transforms.inverse(self.used.world_to_head)
        entry, target = (
            transforms.apply(to_world, point) for point in (plan.entry_ras, plan.target_ras)
        )
        line = (target - entry) / np.linalg.norm(target - entry)
        across = transforms.frame_along(line)[:2]
        tilt = np.tan(np.radians(hands.angle_sd_deg * random.normal(size=2)))
        direction = line + tilt @ across
        direction /= np.linalg.norm(direction)
        tip = entry + hands.entry_sd_mm * random.normal(size=2) @ across - STAND_OFF_MM * direction
        to_head = transforms.inverse(self.head_to_world)
        start, along = transforms.apply(to_head, tip), to_head[:3, :3] @ direction
        bone = bone_ahead(self.skull, start, along, DEPTH_LIMIT_MM)
        stop = STAND_OFF_MM + MISSED_BONE_MM
        if bone is not None and bone.inner_mm is not None:
            stop = bone.inner_mm
        depth = STAND_OFF_MM + plan.length_mm + hands.depth_sd_mm * float(random.normal())
        times = {
            Phase.ALIGNING.value: ALIGNING_S,
            Phase.DRILLING.value: DRILLING_S,
            Phase.INSERTING.value: (STAND_OFF_MM + plan.length_mm) / INSERTION_MM_S + HANDLING_S,
        }
        return PlacedInstrument(
            trajectory=plan.name,
            entry_ras=vector(plan.entry_ras),
            target_ras=vector(plan.target_ras),
            diameter_mm=plan.diameter_mm,
            guide_tip_mm=vector(tip),
            guide_direction=vector(direction),
            alignments=1,
            drill_depth_mm=stop + float(random.exponential(hands.plunge_mm)),
            instrument_depth_mm=depth,
            times_s={name: s / hands.pace * self._spread() for name, s in times.items()},
        )

    def _checked(self, number: int, checkpoint: Checkpoint) -> TouchedCheckpoint:
        """Return the touch of one of the first checkpoints, a few seconds after the last one."""
        place = transforms.apply(self.head_to_world, checkpoint.position_ras)
        place = place + self.hands.check_sd_mm * self.random.normal(size=3)
        shown = transforms.apply(self.used.world_to_head, place)
        error = float(np.linalg.norm(shown - checkpoint.position_ras))
        time_s = self.touching_s + 4.0 * number
        return TouchedCheckpoint(checkpoint.name, vector(place), error, time_s)

    def _spread(self) -> float:
        return float(np.exp(TIME_SD * self.random.normal()))
