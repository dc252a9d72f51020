"""How far a recorded trial's procedure was after each of its events."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rastrainer.procedure.plan import Procedure
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.procedure_state import GuideAxis, ProcedureState, TrajectoryState
from rastrainer_simulator.registration_state import CheckedPoint, FinalRegistration
from rastrainer_simulator.training.registered_plan import RegisteredPlan
from rastrainer_simulator.vectors import vector


def procedure_after(
    before: ProcedureState, entry: Mapping[str, Any], time_s: float, plan: Procedure
) -> ProcedureState:
    """Return how far a procedure is after an event of its trial.

    Args:
        before: the event.
        entry: of the journal.
        time_s: of the event, the trial's.
        plan: as the scenario has it.

    Raises:
        KeyError, TypeError, ValueError: the entry is not as it should be.
    """
    if entry["kind"] == "checkpoint":
        touched = CheckedPoint(
            entry["checkpoint"],
            vector(value / MM_PER_M for value in entry["positionMm"]),
            entry["errorMm"] / MM_PER_M,
            entry["simTime"],
            time_s,
        )
        return replace(before, checkpoints=(*before.checkpoints, touched))
    if "procedure" not in entry:
        return before
    if "registration" in entry:
        before = _registered(before, entry["registration"], plan)
    stage, number = Phase(entry["procedure"]["stage"]), entry["procedure"]["trajectory"]
    if before.stage is Phase.INSERTING and stage is not Phase.INSERTING:
        before = _released(before, entry)
    after = replace(before, stage=stage, trajectory=number)
    if stage is Phase.RUNNING:
        return replace(after, registration=None, checkpoints=(), trajectories=())
    return _locked(after, entry) if "ahead" in entry else after


def _registered(
    before: ProcedureState, arguments: Mapping[str, Any], plan: Procedure
) -> ProcedureState:
    registration = FinalRegistration.from_arguments(arguments)
    registered = RegisteredPlan.of(registration.matrix)
    if registered is None:
        raise ValueError("its registration is not rigid")
    lines = tuple(TrajectoryState(registered.line(each)) for each in plan.trajectories)
    return replace(before, registration=registration, trajectories=lines)


def _locked(before: ProcedureState, entry: Mapping[str, Any]) -> ProcedureState:
    tip = vector(value / MM_PER_M for value in entry["positionMm"])
    here = before.trajectories[before.trajectory]
    guide = GuideAxis(tip, vector(entry["direction"]))
    return before.with_present(replace(here, alignments=here.alignments + 1, guide=guide))


def _released(before: ProcedureState, entry: Mapping[str, Any]) -> ProcedureState:
    here = before.trajectories[before.trajectory]
    depth = entry.get("feedMm", 0.0) / MM_PER_M
    return before.with_present(replace(here, instrument_depth=depth))
