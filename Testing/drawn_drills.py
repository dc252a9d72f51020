"""Drills of decisions by trainees whose sensitivity, criterion and confidence are known."""

from __future__ import annotations

import uuid
from collections.abc import Mapping, Sequence

import numpy as np

from rastrainer.decision.drill_record import (
    CASES,
    CONFIDENCES,
    FAULTS,
    DecidedCase,
    Decision,
    DrillRecord,
    Fault,
)
from rastrainer.protocol import RegistrationMethod

LIMIT_MM = 3.0
NO_BLIND_SPOTS: Mapping[Fault, float] = {}


def draw_drill(
    random: np.random.Generator,
    trainee: str = "T-001",
    day: int = 1,
    sensitivity: float = 1.5,
    criterion: float = 0.0,
    blind_spots: Mapping[Fault, float] = NO_BLIND_SPOTS,
    cases: int = CASES,
    overconfidence: float = 1.0,
) -> DrillRecord:
    """Return a drill of a trainee who follows a model of equal variances.

    The evidence of a case is normal with standard deviation 1 and a mean of half the sensitivity
    if the case is over the limit, minus half of it if the case is sound. `blind_spots` reduce the
    evidence of faults. `overconfidence` multiplies the logit of the right probability.
    """
    faults = random.permutation(len(FAULTS))
    decided = []
    for number in random.permutation(cases):
        is_sound = number < cases // 2
        fault = Fault.NONE if is_sound else FAULTS[faults[number % len(FAULTS)]]
        evidence = random.normal(-sensitivity / 2 if is_sound else sensitivity / 2)
        evidence -= blind_spots.get(fault, 0.0)
        decision = Decision.PROCEED
        if evidence > criterion:
            decision = Decision.STOP if random.random() < 0.3 else Decision.REGISTER_AGAIN
        # Bayes' rule, for a trainee who may think that the criterion is 0.
        probability = 1.0 / (1.0 + np.exp(-overconfidence * sensitivity * abs(evidence)))
        guess = fault if random.random() < 0.6 else FAULTS[random.integers(len(FAULTS))]
        decided.append(
            DecidedCase(
                seed=int(random.integers(2**62)),
                fault=fault,
                method=RegistrationMethod.FIDUCIALS,
                limit_mm=LIMIT_MM,
                true_error_mm=LIMIT_MM * random.uniform(0.2, 1.0) + (0 if is_sound else LIMIT_MM),
                expected_error_mm=random.uniform(0.8, 2.0),
                residual_mm=random.uniform(0.5, 2.5),
                difficulty=random.normal(0.0, 0.7),
                checks=("nose", "left canthus", "fiducial 7")[: random.integers(4)],
                has_read_images=bool(random.random() < 0.5),
                decision=decision,
                confidence=min(CONFIDENCES, key=lambda stated: abs(stated - 100 * probability)),
                suspected=None if decision is Decision.PROCEED else guess,
                time_s=random.uniform(20.0, 110.0),
            )
        )
    return DrillRecord(
        trial_id=str(uuid.UUID(int=int(random.integers(2**62)), version=4)),
        trainee=trainee,
        mode="desktop",
        scenario="colin27",
        started_utc=f"2026-05-{day:02d}T08:00:00Z",
        completed_utc=f"2026-05-{day:02d}T08:30:00Z",
        cases=tuple(decided),
        versions={"simulator": "0.1.0"},
    )


def draw_drills(
    random: np.random.Generator,
    trainees: int,
    sensitivities: Sequence[float] = (1.0, 1.4, 1.6, 1.8, 1.9),
    spread: float = 0.4,
    first: int = 0,
    **model: float | Mapping[Fault, float],
) -> tuple[DrillRecord, ...]:
    """Return the drills of some trainees, who play one a day.

    `sensitivities` has the mean of each drill; each trainee differs from the means by a normal
    number with the standard deviation `spread`.
    """
    own = random.normal(0.0, spread, trainees)
    return tuple(
        draw_drill(random, f"T{first + index:03d}", day, mean + own[index], **model)
        for index in range(trainees)
        for day, mean in enumerate(sensitivities, start=1)
    )
