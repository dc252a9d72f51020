"""Virtual trainees: what is true of them, so that a study's estimates can be checked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.protocol import SPEED_LIMIT_MM_S
from rastrainer.scripted_trainee import Skill

SLOWEST_MM_S = 15.0
STEADIEST_MM = 0.02


@dataclass(frozen=True)
class ModeEffect:
    """What a mode does to everyone's hands: factors on speed and on the scatter of the aim."""

    speed: float = 1.0
    aim: float = 1.0


@dataclass(frozen=True)
class Population:
    """From whom virtual trainees are drawn.

    Attributes:
        skill: Of the typical trainee at the first trial.
        speed_spread: Standard deviation, between trainees, of the logarithm of the speed.
        aim_spread: The same of the scatter of the aim.
        learning: b; with the n-th trial, speed and pauses improve by the factor n^b.
        modes: Effect of each mode; none for those left out.
    """

    skill: Skill = field(default_factory=Skill)
    speed_spread: float = 0.15
    aim_spread: float = 0.15
    learning: float = 0.15
    modes: Mapping[str, ModeEffect] = field(default_factory=dict)

    def __post_init__(self) -> None:
        effects = [f for effect in self.modes.values() for f in (effect.speed, effect.aim)]
        if not all(0.1 <= factor <= 10 for factor in effects):
            raise InputError("The effects of a mode must be factors from 0.1 to 10.")
        spreads = (self.speed_spread, self.aim_spread, self.learning)
        if not all(0 <= value <= 1 for value in spreads):
            raise InputError("Spreads and the learning exponent must be from 0 to 1.")

    def skill_of(self, trainee: int, mode: str, trial: int, seed: int) -> Skill:
        """Return the hands of a trainee in his or her n-th trial of all, the first is 1.

        The same seed gives the same trainees, however many there are.
        """
        random = np.random.default_rng([seed, trainee])
        own_speed, own_aim = np.exp(random.normal(0.0, [self.speed_spread, self.aim_spread]))
        effect = self.modes.get(mode, ModeEffect())
        practice = trial**self.learning
        speed = self.skill.speed_mm_s * own_speed * effect.speed * practice
        brisk = own_speed * practice
        return replace(
            self.skill,
            speed_mm_s=float(np.clip(speed, SLOWEST_MM_S, 0.9 * SPEED_LIMIT_MM_S)),
            gain_per_s=float(np.clip(self.skill.gain_per_s * own_speed * effect.speed, 0.5, 9.0)),
            aim_sd_mm=float(max(self.skill.aim_sd_mm * own_aim * effect.aim, STEADIEST_MM)),
            reaction_s=self.skill.reaction_s / brisk,
            dwell_s=self.skill.dwell_s / brisk,
        )
