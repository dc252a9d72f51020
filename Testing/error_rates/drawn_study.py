"""A study that follows a protocol, drawn from the model of outcomes instead of played."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from rastrainer.study.protocol.steps import Step, StepKind, steps_for
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer_simulator.virtual.outcome_model import DrawnTrials, OutcomeModel, draw_trials
from rastrainer_simulator.virtual.population import pseudonym


def draw_protocol_study(
    model: OutcomeModel, protocol: StudyProtocol, trainees: int, random: np.random.Generator
) -> StudyData:
    """Return a study whose modes and tasks come in the protocol's orders.

    Args:
        model: The truth; its tasks are those of the protocol.
        protocol: What each trainee does.
        trainees: How many.
        random: Of the draws.
    """
    rounds = protocol.repetitions
    repeated = replace(
        model,
        task_times_s=list(model.task_times_s) * rounds,
        task_fle_mm=list(model.task_fle_mm) * rounds,
    )
    shape = (trainees, len(protocol.modes), len(protocol.tasks) * rounds)
    numbers = np.zeros(shape, dtype=int)
    for trainee in range(trainees):
        for number, (mode, slot, _step) in enumerate(_trials(protocol, trainee), start=1):
            numbers[trainee, mode, slot] = number
    drawn = draw_trials(repeated, protocol.modes, random, numbers)
    rows = tuple(row for i in range(trainees) for row in _rows(protocol, i, drawn))
    return StudyData("Simulated outcomes", rows, has_order=True)


def _trials(protocol: StudyProtocol, trainee: int) -> Iterator[tuple[int, int, Step]]:
    """Yield mode and place in the last axis of each trial of a trainee, in their order."""
    for step in steps_for(protocol, trainee):
        if step.kind is StepKind.TRIAL:
            slot = (step.round - 1) * len(protocol.tasks) + protocol.tasks.index(step.task)
            yield protocol.modes.index(step.mode), slot, step


def _rows(protocol: StudyProtocol, trainee: int, drawn: DrawnTrials) -> Iterator[TrialRow]:
    counts = dict.fromkeys(protocol.modes, 0)
    for mode, slot, step in _trials(protocol, trainee):
        counts[step.mode] += 1
        place = trainee, mode, slot
        values = {
            "completion_time_s": float(drawn.times_s[place]),
            "rmse_mm": float(drawn.errors_mm[place]),
            "true_tre_mm": float(drawn.true_tre_mm[place]),
            "undone_touches": int(drawn.lapses[place]),
        }
        yield TrialRow(pseudonym(trainee), step.mode, step.task, counts[step.mode], values)
