"""Procedures for the trials of a study in tests: errors by a registration and by hands."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np

from rastrainer import transforms
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import Procedure, ProcedureKind
from rastrainer.procedure.record import ProcedureRecord
from rastrainer.study.study_data import StudyData
from rastrainer.trial.procedure_outcome import ProcedureMeasures, ProcedureOutcome, score_procedure
from Testing.domain.procedure.made_up_procedure import made_up_meshes, made_up_procedure
from Testing.domain.procedure.procedure_records import recorded

SHIFT_MM = np.array([0.3, 0.4, 0.0])
"""A registration moves the whole plan by 0.5 mm."""
TOO_DEEP_MM = 1.2


def carried_out(
    kind: ProcedureKind, number: int = 0, by_robot: bool = False
) -> tuple[Procedure, ProcedureRecord]:
    """Return plan and record of a procedure whose lines are shifted, its instruments too deep.

    `number` makes the shift larger, and the hands stay the same. `by_robot` has the robot align the
    guide on the first line, and the instrument is twice as much too deep there.
    """
    procedure = replace(made_up_procedure(), name=kind.value, kind=kind)
    shift = transforms.rigid(np.eye(3), SHIFT_MM * (1 + number))
    done = recorded(procedure, shift, drill=15.0)
    deeper = tuple(
        replace(one, instrument_depth_mm=one.instrument_depth_mm + TOO_DEEP_MM)
        for one in done.instruments
    )
    if by_robot:
        twice = deeper[0].instrument_depth_mm + TOO_DEEP_MM
        first = replace(deeper[0], self_aligned=True, instrument_depth_mm=twice)
        deeper = (first, *deeper[1:])
    return procedure, replace(done, instruments=deeper)


@lru_cache
def outcome(kind: ProcedureKind, number: int = 0, by_robot: bool = False) -> ProcedureOutcome:
    """Return the outcome of `carried_out`."""
    procedure, done = carried_out(kind, number, by_robot)
    analysis = analyze_procedure(done, procedure, made_up_meshes(), np.eye(4))
    return ProcedureOutcome(
        analysis, score_procedure(ProcedureMeasures.of(analysis, procedure), 300.0)
    )


def with_procedures(data: StudyData, by_robot: bool = False) -> StudyData:
    """Return a study whose trials continued with a procedure, of each kind in turn.

    `by_robot` has the robot align the guide on the first of the two lines of each.
    """
    kinds = list(ProcedureKind)
    return replace(
        data,
        trials=tuple(
            replace(trial, procedure=outcome(kinds[row % len(kinds)], row % 4, by_robot))
            for row, trial in enumerate(data.trials)
        ),
    )
