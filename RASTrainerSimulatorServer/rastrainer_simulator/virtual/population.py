"""The trainees of a simulated cohort and their trials, in the order of the study's protocol."""

from __future__ import annotations

import math
import uuid
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from datetime import datetime, timedelta, timezone

import numpy as np

from rastrainer.errors import InputError
from rastrainer.protocol import SPEED_LIMIT_MM_S, Mode, StepKind
from rastrainer.study.protocol.study_protocol import StudyProtocol, steps_for
from rastrainer_simulator.virtual.hand import Skill

NAMESPACE = uuid.UUID("2b1f9c1e-52dd-5f0c-9c51-5261546f686f")
FIRST_DAY = datetime(2000, 1, 1, 9, tzinfo=timezone.utc)
"""Virtual trials have dates that cannot be mistaken for real dates."""


@dataclass(frozen=True)
class TrialJob:
    """One trial to be played, and the procedure that it continues with, if any.

    The seed gives the head's pose and the hands.
    """

    trainee: str
    step: str
    mode: str
    task: str
    skill: Skill
    seed: int
    started: datetime
    procedure: str = ""

    @property
    def trial_id(self) -> str:
        return str(uuid.uuid5(NAMESPACE, f"{self.trainee} {self.step} {self.seed}"))


def trial_jobs(
    protocol: StudyProtocol, population: Population, trainees: int, seed: int
) -> Iterator[TrialJob]:
    """Yield the trials of a cohort, trainee by trainee; trial runs are not played."""
    for place in range(trainees):
        number = 0
        for step in steps_for(protocol, place):
            if step.kind is not StepKind.TRIAL:
                continue
            number += 1
            source = np.random.SeedSequence([seed, place, number])
            yield TrialJob(
                trainee=pseudonym(place),
                step=step.name,
                mode=step.mode,
                task=step.task,
                skill=population.skill_of(place, step.mode, number, seed),
                seed=int(source.generate_state(1, np.uint64)[0] >> 1),
                started=FIRST_DAY + timedelta(days=place, minutes=10 * number),
                procedure=step.procedure,
            )


def pseudonym(place: int) -> str:
    """Return the name of the trainee at a place, from 0."""
    return f"V{place + 1:04d}"


SLOWEST_MM_S = 15.0
GAIN_PER_S = (0.5, 9.0)
STEADIEST_MM = 0.02
LARGEST_BIAS_MM = 5.0

_MODES = [mode.value for mode in Mode]
_INTERACTION, _TRIAL = 1, 2
"""Further random streams of a trainee: draws from one change no other."""


@dataclass(frozen=True)
class ModeEffect:
    """The effect of a mode on every trainee.

    Attributes:
        speed: Factor on the pace of the hands: speed, gain and, inversely, pauses.
        aim: Factor on the scatter.
        bias_mm: Systematic error of the aim, as by a distorted view: x, y, z in `World`, mm; only
            its part along the skin has an effect, since the tip is on the skin.
    """

    speed: float = 1.0
    aim: float = 1.0
    bias_mm: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Population:
    """The distribution of virtual trainees.

    Scatter means the aim's, the tip's where it settles, and the hand's drift: all three are scaled
    alike, so that the localization error is in proportion. Tremor is physiological: practice leaves
    it as it is. Pace scales speed, gain and pauses, so
    that times are in inverse proportion, up to the robot's speed limit.

    Attributes:
        skill: Of the typical trainee at the first trial.
        speed_spread: Standard deviation, between trainees, of the logarithm of the pace.
        aim_spread: The same of the scatter.
        learning: b; the n-th trial of all takes n^−b of the first one's time.
        modes: Effect of each mode; none for those left out.
        accuracy_learning: The same exponent of the scatter.
        interaction: Standard deviation, between trainees and modes, of the logarithms of pace and
            scatter: how differently a mode suits different trainees.
        tempo_spread: Standard deviation, between trials of a trainee, of the logarithm of the
            pace: haste and leisure.
        trade_off: k; a trial played x times as fast as usual has a scatter x^k times as large.
        lapses: Share of trials in which one touch slips by 4 mm, is noticed and taken back; None
            for `skill.slip_at`.
    """

    skill: Skill = field(default_factory=Skill)
    speed_spread: float = 0.15
    aim_spread: float = 0.15
    learning: float = 0.15
    modes: Mapping[str, ModeEffect] = field(default_factory=dict)
    accuracy_learning: float = 0.0
    interaction: float = 0.0
    tempo_spread: float = 0.0
    trade_off: float = 0.0
    lapses: float | None = None

    def __post_init__(self) -> None:
        effects = [f for effect in self.modes.values() for f in (effect.speed, effect.aim)]
        if not all(0.1 <= factor <= 10 for factor in effects):
            raise InputError("The effects of a mode must be factors from 0.1 to 10.")
        biases = [part for effect in self.modes.values() for part in effect.bias_mm]
        if not all(abs(part) <= LARGEST_BIAS_MM for part in biases):
            raise InputError(f"The bias of a view must be at most {LARGEST_BIAS_MM:g} mm an axis.")
        spreads = (self.speed_spread, self.aim_spread, self.interaction, self.tempo_spread)
        exponents = (self.learning, self.accuracy_learning, self.lapses or 0.0)
        if not all(0 <= value <= 1 for value in (*spreads, *exponents)):
            raise InputError("Spreads, learning exponents and lapses must be from 0 to 1.")
        if not 0 <= self.trade_off <= 2:
            raise InputError("The exponent of speed and accuracy must be from 0 to 2.")

    def skill_of(self, trainee: int, mode: str, trial: int, seed: int) -> Skill:
        """Return the skill of a trainee in the n-th trial of all, from 1.

        The same seed gives the same trainees, however many there are.
        """
        random = np.random.default_rng([seed, trainee])
        own_speed, own_aim = np.exp(random.normal(0.0, [self.speed_spread, self.aim_spread]))
        of_mode = np.random.default_rng([seed, trainee, _INTERACTION, _MODES.index(mode)])
        suits_speed, suits_aim = np.exp(of_mode.normal(0.0, self.interaction, 2))
        of_trial = np.random.default_rng([seed, trainee, _TRIAL, trial])
        tempo = math.exp(of_trial.normal(0.0, self.tempo_spread))
        effect = self.modes.get(mode, ModeEffect())
        pace = own_speed * suits_speed * effect.speed * tempo * trial**self.learning
        scatter = own_aim * suits_aim * effect.aim * tempo**self.trade_off
        scatter *= trial**-self.accuracy_learning
        own = self.skill
        slip_at = own.slip_at
        if self.lapses is not None:
            # The trial's own seed decides at which fiducial.
            slip_at = 2 if of_trial.random() < self.lapses else None
        return replace(
            own,
            speed_mm_s=float(np.clip(own.speed_mm_s * pace, SLOWEST_MM_S, 0.9 * SPEED_LIMIT_MM_S)),
            gain_per_s=float(np.clip(own.gain_per_s * pace, *GAIN_PER_S)),
            aim_sd_mm=float(max(own.aim_sd_mm * scatter, STEADIEST_MM)),
            settled_mm=float(max(own.settled_mm * scatter, STEADIEST_MM)),
            drift_mm_s=float(own.drift_mm_s * scatter),
            aim_bias_mm=effect.bias_mm,
            reaction_s=float(own.reaction_s / pace),
            dwell_s=float(own.dwell_s / pace),
            slip_at=slip_at,
        )
