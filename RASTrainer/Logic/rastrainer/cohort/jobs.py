"""The trials of a simulated cohort: one job each, in the order of the study's protocol."""

from __future__ import annotations

import uuid
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import datetime, timedelta, timezone

import numpy as np

from rastrainer.cohort.population import Population
from rastrainer.experiment.steps import StepKind, steps_for
from rastrainer.experiment.study_protocol import StudyProtocol
from rastrainer.scripted_trainee import Skill

NAMESPACE = uuid.UUID("2b1f9c1e-52dd-5f0c-9c51-5261546f686f")
FIRST_DAY = datetime(2000, 1, 1, 9, tzinfo=timezone.utc)
"""Virtual trials bear dates that nobody takes for real ones."""


@dataclass(frozen=True)
class TrialJob:
    """One trial to be played.

    Attributes:
        trainee: Pseudonym, `V0001` and on.
        step: Name of the protocol's step.
        mode: `desktop` or `hmd`.
        task: Name of the task.
        skill: Of the hands in this trial.
        seed: Of the head's pose and of the hands.
        started: When it is said to have begun.
    """

    trainee: str
    step: str
    mode: str
    task: str
    skill: Skill
    seed: int
    started: datetime

    @property
    def trial_id(self) -> str:
        """UUID of the trial, which follows from the job."""
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
            )


def pseudonym(place: int) -> str:
    """Return the name of the trainee at a place, the first is 0."""
    return f"V{place + 1:04d}"
