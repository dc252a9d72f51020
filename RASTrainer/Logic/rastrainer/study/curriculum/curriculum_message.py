"""A trainee's standing in a curriculum, as Slicer sends it to the simulator (`Curriculum`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from typing import Any

from rastrainer.protocol import AssignmentState, GoalKind, RegistrationMethod
from rastrainer.study.curriculum.standing import AssignmentStanding, CurriculumStanding


@dataclass(frozen=True)
class AssignmentMessage:
    """An assignment and where the trainee stands with it; see `AssignmentStanding`.

    Attributes:
        method: A `PLAYED_METHODS`; "" for fiducials.
        mark: Score that passes; 0 without one.
    """

    name: str
    task: str
    goal: str
    state: str
    needed: int
    scenario: str = ""
    mode: str = ""
    method: str = ""
    procedure: str = ""
    done: int = 0
    mark: float = 0.0
    played: int = 0
    missing: tuple[str, ...] = ()
    weakest: str = ""

    @classmethod
    def of(cls, standing: AssignmentStanding) -> AssignmentMessage:
        """Return the message about a standing."""
        each = standing.assignment
        return cls(
            name=each.name,
            task=each.task,
            goal=each.goal.value,
            state=standing.state.value,
            needed=standing.needed,
            scenario=each.scenario,
            mode=each.mode,
            method="" if each.method == RegistrationMethod.FIDUCIALS.value else each.method,
            procedure=each.procedure,
            done=standing.done,
            mark=standing.mark or 0.0,
            played=standing.played,
            missing=standing.missing,
            weakest=standing.weakest,
        )

    @property
    def is_locked(self) -> bool:
        """Whether others have to be reached first."""
        return self.state == AssignmentState.LOCKED.value

    @property
    def is_reached(self) -> bool:
        return self.state == AssignmentState.REACHED.value

    @property
    def is_by_competence(self) -> bool:
        """Whether its goal is competence by LC-CUSUM; else, trials in a row that pass."""
        return self.goal == GoalKind.COMPETENT.value

    def is_played_as(
        self, scenario: str, task: str, mode: str, method: str, procedure: str
    ) -> bool:
        """Return whether such a trial counts for it."""
        if self.scenario not in ("", scenario) or self.mode not in ("", mode):
            return False
        own = self.method or RegistrationMethod.FIDUCIALS.value
        return (self.task, own, self.procedure) == (task, method, procedure)


@dataclass(frozen=True)
class CurriculumMessage:
    """What a trainee's menu shows of a curriculum.

    Attributes:
        trainee: Pseudonym.
        title: Of the curriculum, for people.
        next: Name of the assignment to practice next; "" for none.
        assignments: In their order; none for a trainee without a curriculum.
    """

    trainee: str
    title: str = ""
    next: str = ""
    assignments: tuple[AssignmentMessage, ...] = ()

    @classmethod
    def of(cls, trainee: str, standing: CurriculumStanding | None) -> CurriculumMessage:
        """Return the message about a trainee's standing."""
        if standing is None:
            return cls(trainee)
        best = standing.next_best
        return cls(
            trainee,
            standing.curriculum.title,
            "" if best is None else best.assignment.name,
            tuple(AssignmentMessage.of(each) for each in standing.standings),
        )

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> CurriculumMessage:
        assignments = tuple(AssignmentMessage(**asdict(each)) for each in arguments["assignments"])
        return cls(**{**arguments, "assignments": assignments})

    def arguments(self) -> dict[str, Any]:
        """Return the command arguments, without empty ones."""
        assignments = [
            {name: value for name, value in asdict(each).items() if value not in ("", 0, ())}
            for each in self.assignments
        ]
        for each in assignments:
            if "missing" in each:
                each["missing"] = list(each["missing"])
        texts = {"title": self.title, "next": self.next}
        others = {name: value for name, value in texts.items() if value}
        return {
            "trainee": self.trainee,
            **others,
            **({"assignments": assignments} if assignments else {}),
        }

    @property
    def reached(self) -> int:
        return sum(each.is_reached for each in self.assignments)

    def find(self, name: str) -> AssignmentMessage | None:
        return next((each for each in self.assignments if each.name == name), None)
