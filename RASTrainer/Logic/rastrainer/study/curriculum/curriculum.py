"""A curriculum and its file: assignments, each with a goal, and which come before it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

from rastrainer.errors import InputError
from rastrainer.json_checks import identifier, list_of, text
from rastrainer.protocol import DECIDE, MAX_ASSIGNMENTS, GoalKind
from rastrainer.study.protocol.plan_file import PlanFile
from rastrainer.study_messages import FIDUCIALS, Assignment


@dataclass(frozen=True)
class Curriculum(PlanFile):
    """The assignments of a trainee, in order."""

    WHAT = "The curriculum"
    VERSIONS: ClassVar = {"formatVersion": 1}
    name: Annotated[str, identifier]
    title: Annotated[str, text(80)]
    assignments: Annotated[tuple[Assignment, ...], list_of(1, MAX_ASSIGNMENTS, "objects")]

    def __post_init__(self) -> None:
        earlier: set[str] = set()
        for each in self.assignments:
            what = f"The curriculum {self.name}: assignment {each.name}"
            if each.name in earlier:
                raise InputError(f"{what}: name must be one that no other assignment has.")
            if not set(each.after) <= earlier:
                raise InputError(
                    f"{what}: after must be a list of assignments that stand before this one."
                )
            is_marked = each.method != FIDUCIALS or each.procedure or each.mark is not None
            if each.task == DECIDE and (is_marked or each.goal is GoalKind.COMPETENT):
                raise InputError(
                    f"{what}: method, procedure, mark and the goal competent must be left out of "
                    "the task decide, whose drills are passed by their error rates alone."
                )
            earlier.add(each.name)
