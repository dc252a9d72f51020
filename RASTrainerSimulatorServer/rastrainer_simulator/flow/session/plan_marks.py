"""The plan of a procedure as it is drawn: by the trainee's own registration, until the score.

Checkpoints are marks on the patient's skin, as fiducials are: they are drawn where they truly are.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from rastrainer.procedure.geometry import BoneAhead
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.presentation.screen import DepthRuler, ErrorArrow, Tone
from rastrainer_simulator.texts.texts import Texts
from rastrainer_simulator.trial_state import PlannedLine, ProcedureState, TrajectoryState
from rastrainer_simulator.vectors import Vector, add, dot, scale, subtract

BEFORE_ENTRY_M = 0.05
"""The current line begins this far outside of the head: the guide is brought onto it there."""
PLANNED, SHOWN, PLACED = Tone.GOOD, Tone.WARNING, Tone.PLAIN
"""Colors of the lines after the score: planned, shown by the registration, and placed."""


def plan_marks(
    procedure: ProcedureState, bone: Sequence[BoneAhead | None]
) -> tuple[ErrorArrow, ...]:
    """Return the lines of a plan as they are drawn, by the registration; () before it is accepted.

    The current one has its entry and the tables of the skull on it.
    """
    marks: list[ErrorArrow] = []
    for number, trajectory in enumerate(procedure.trajectories if procedure.present else ()):
        line = trajectory.line
        if number != procedure.trajectory:
            marks.append(drawn(line, Tone.PLAIN))
            continue
        marks += [drawn(line, PLANNED, BEFORE_ENTRY_M), ball(line.entry, PLANNED)]
        tables = bone[number] if number < len(bone) else None
        depths = () if tables is None else (tables.outer_mm, tables.inner_mm)
        marks += [ball(_on(line, depth), SHOWN) for depth in depths if depth is not None]
    return tuple(marks)


def depth_ruler(
    trajectory: TrajectoryState, bone: BoneAhead | None, texts: Texts
) -> DepthRuler | None:
    """Return the scale along the axis of a locked guide; None before it is locked."""
    guide, line = trajectory.guide, trajectory.line
    if guide is None:
        return None

    def along(point: Vector) -> float:
        return MM_PER_M * dot(subtract(point, guide.tip), guide.direction)

    inner = None if bone is None else bone.inner_mm
    return DepthRuler(
        along(line.entry),
        None if bone is None else along(_on(line, bone.outer_mm)),
        None if inner is None else along(_on(line, inner)),
        along(line.target),
        tuple(texts.say(f"ruler.{name}") for name in ("entry", "outer", "inner", "target")),
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


def _on(line: PlannedLine, depth_mm: float) -> Vector:
    return add(line.entry, scale(line.direction, depth_mm / MM_PER_M))
