"""A curriculum and its file: assignments, each with a goal, and which come before it."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rastrainer.files.json_fields import Fields, fields_of, read_fields
from rastrainer.protocol import (
    MAX_ASSIGNMENTS,
    MAX_GATES,
    MAX_GOAL_TRIALS,
    PLAYED_METHODS,
    TRIAL_RUN,
    GoalKind,
    Mode,
    RegistrationMethod,
)

FORMAT_VERSION = 1
MAX_TITLE = 80
_KEYS = ("formatVersion", "name", "title", "assignments")
_ASSIGNMENT_KEYS = ("name", "task", "scenario", "mode", "method", "procedure", "goal", "after")
_GOAL_KEYS = {
    GoalKind.SCORE.value: ("kind", "trials", "mark"),
    GoalKind.COMPETENT.value: ("kind", "mark"),
}


@dataclass(frozen=True)
class Assignment:
    """A task that is played until a goal is reached.

    Attributes:
        name: Unique in its curriculum.
        task: Name of the task.
        scenario: Name of the scenario whose task it is; "" for any that has it.
        mode: Display mode; "" for any.
        method: By what its trials are registered, a `PLAYED_METHODS`.
        procedure: That its trials continue with, and whose score counts; "" for touches alone.
        goal: Kind of the goal.
        trials: How many trials in a row are to pass; 0 for a goal by LC-CUSUM.
        mark: Score that passes; None for the pass mark of the study.
        after: Names of earlier assignments that have to be reached before this one opens.
    """

    name: str
    task: str
    scenario: str = ""
    mode: str = ""
    method: str = RegistrationMethod.FIDUCIALS.value
    procedure: str = ""
    goal: GoalKind = GoalKind.SCORE
    trials: int = 1
    mark: float | None = None
    after: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """Return the object that a curriculum's file holds."""
        goal: dict[str, Any] = {"kind": self.goal.value}
        if self.goal is GoalKind.SCORE:
            goal["trials"] = self.trials
        if self.mark is not None:
            goal["mark"] = self.mark
        chosen = {
            "scenario": self.scenario,
            "mode": self.mode,
            "method": self.method,
            "procedure": self.procedure,
        }
        return {
            "name": self.name,
            "task": self.task,
            **{name: value for name, value in chosen.items() if value},
            "goal": goal,
            **({"after": list(self.after)} if self.after else {}),
        }


@dataclass(frozen=True)
class Curriculum:
    """What a trainee should reach.

    Attributes:
        name: Short; `title` is for people.
        assignments: In the order of listing; at least one.
    """

    name: str
    title: str
    assignments: tuple[Assignment, ...]

    def to_json(self) -> dict[str, Any]:
        """Return the object that the file holds."""
        return {
            "formatVersion": FORMAT_VERSION,
            "name": self.name,
            "title": self.title,
            "assignments": [assignment.to_json() for assignment in self.assignments],
        }


def read_curriculum(path: Path | str) -> Curriculum:
    """Read a curriculum's file."""
    return _curriculum(read_fields(Path(path)))


def curriculum_from_json(value: Any) -> Curriculum:
    """Return the curriculum of a `to_json` object; raise `InputError` if invalid."""
    return _curriculum(fields_of(value, "curriculum"))


def _curriculum(fields: Fields) -> Curriculum:
    fields.check_names(_KEYS, "a curriculum")
    fields.check_format(FORMAT_VERSION)
    name, title = fields.identifier("name"), fields.text("title", MAX_TITLE)
    assignments: list[Assignment] = []
    for entry in fields.list_of_fields("assignments", 1, MAX_ASSIGNMENTS):
        assignments.append(_assignment(entry, [earlier.name for earlier in assignments]))
    return Curriculum(name, title, tuple(assignments))


def _assignment(fields: Fields, earlier: list[str]) -> Assignment:
    fields.check_names(_ASSIGNMENT_KEYS, "an assignment")
    name, task = fields.identifier("name"), fields.identifier("task")
    if name in earlier:
        raise fields.error("name", "one that no other assignment has")
    if task == TRIAL_RUN:
        raise fields.error("task", "a task that is scored; the trial run is not")
    given, goal = fields.names(), fields.fields("goal")
    kind = GoalKind(goal.one_of("kind", tuple(kind.value for kind in GoalKind)))
    goal.check_names(_GOAL_KEYS[kind.value], f"the goal {kind.value}")
    modes, methods = (tuple(each.value for each in kinds) for kinds in (Mode, PLAYED_METHODS))
    fiducials = RegistrationMethod.FIDUCIALS.value
    after = fields.texts("after", 0, MAX_GATES) if "after" in given else ()
    if not set(after) <= set(earlier):
        raise fields.error("after", "a list of assignments that stand before this one")
    return Assignment(
        name=name,
        task=task,
        scenario=fields.identifier("scenario") if "scenario" in given else "",
        mode=fields.one_of("mode", modes) if "mode" in given else "",
        method=fields.one_of("method", methods) if "method" in given else fiducials,
        procedure=fields.identifier("procedure") if "procedure" in given else "",
        goal=kind,
        trials=goal.whole_number("trials", 1, MAX_GOAL_TRIALS) if kind is GoalKind.SCORE else 0,
        mark=goal.number("mark", 1, 100) if "mark" in goal.names() else None,
        after=after,
    )
