"""The plan of a procedure as it is drawn: by the trainee's own registration, until the score.

Checkpoints are marks on the patient's skin, as fiducials are: they are drawn where they truly are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from rastrainer.procedure.geometry import BoneAhead
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.presentation.screen import ErrorArrow, Tone
from rastrainer_simulator.trial_state import PlannedLine, ProcedureState
from rastrainer_simulator.vectors import Vector, add, scale

BEFORE_ENTRY_M = 0.05
"""The current line begins this far outside of the head: the guide is brought onto it there."""
PLANNED, SHOWN, PLACED = Tone.GOOD, Tone.WARNING, Tone.PLAIN
"""Colors of the lines after the score: planned, shown by the registration, and placed."""


def plan_marks(procedure: ProcedureState, bone: BoneAhead | None) -> tuple[ErrorArrow, ...]:
    """Return the lines of a plan as they are drawn, by the registration; () before it is accepted.

    The current line has its entry and the tables of the skull on it; `bone` is ahead of it.
    """
    present = procedure.present
    if present is None:
        return ()
    line = present.line
    others = [drawn(e.line, Tone.PLAIN) for e in procedure.trajectories if e is not present]
    depths = () if bone is None else (bone.outer_mm, bone.inner_mm)
    tables = [
        add(line.entry, scale(line.direction, depth / MM_PER_M))
        for depth in depths
        if depth is not None
    ]
    return (
        *others,
        drawn(line, PLANNED, BEFORE_ENTRY_M),
        ball(line.entry, PLANNED),
        *(ball(table, SHOWN) for table in tables),
    )


def scored_lines(plan: Iterable[PlannedLine], procedure: ProcedureState) -> Iterator[ErrorArrow]:
    """Yield the planned lines where they truly are, and the registered and the placed lines."""
    for true, trajectory in zip(plan, procedure.trajectories, strict=True):
        yield drawn(true, PLANNED)
        yield drawn(trajectory.line, SHOWN)
        guide, depth = trajectory.guide, trajectory.instrument_depth
        if guide is not None and depth is not None:
            end = add(guide.tip, scale(guide.direction, depth))
            yield ErrorArrow(guide.tip, end, PLACED)


def drawn(line: PlannedLine, tone: Tone, before_m: float = 0.0) -> ErrorArrow:
    begin = add(line.entry, scale(line.direction, -before_m))
    return ErrorArrow(begin, line.target, tone)


def ball(place: Vector, tone: Tone, name: str = "") -> ErrorArrow:
    return ErrorArrow(place, place, tone, name)
