"""What Slicer tells the simulator of a study: a trainee's next step, and standing in a curriculum.

Both are also what protocol and curriculum plan. A key that stands here is stored, travels and is
checked by that.
"""

from __future__ import annotations

import contextlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any

from rastrainer import protocol
from rastrainer.errors import InputError
from rastrainer.json_checks import identifier, list_of, number, one_of, text, texts, whole_number
from rastrainer.protocol import ALL_DONE, FREE, REPEAT, SKIN_KEYS, SKIN_LIMIT_MM, TRIAL_RUN

WHOLE_WAY = 100
"""Percent of the way to competence."""
FIDUCIALS = protocol.RegistrationMethod.FIDUCIALS.value


def skin_amounts(value: Any) -> dict[str, float]:
    """Accept how far the skin shifts (RMS) and is indented, mm; a missing amount is 0."""
    check = number(0, SKIN_LIMIT_MM)
    with contextlib.suppress(ValueError):
        if isinstance(value, Mapping) and set(value) <= set(SKIN_KEYS):
            return {key: check(amount) for key, amount in value.items()}
    raise ValueError(
        f"an object of {' and '.join(SKIN_KEYS)}, each a number from 0 to {SKIN_LIMIT_MM:g} mm"
    )


_Name = Annotated[str, identifier]
AnyMode = Annotated[str, one_of(*protocol.Mode)]
PlayedMethod = Annotated[str, one_of(*protocol.PLAYED_METHODS)]
GuidanceRule = Annotated[str, one_of(*protocol.Guidance)]
GhostChoice = Annotated[str, one_of(*protocol.GhostRule)]
TutorialChoice = Annotated[str, one_of(*protocol.TutorialRule)]
Skin = Annotated[Mapping[str, float], skin_amounts]
Allowances = tuple[Annotated[str, text(20)], ...]
_Minutes = Annotated[float, number(0, 43_200, "min")]


@dataclass(frozen=True)
class StudyStep:
    """A step of a trainee through a study; texts that do not apply are empty.

    Its `kind` is a `StepKind`, `REPEAT` if an aborted trial needs a reason, `ALL_DONE` after the
    last step, or `FREE` without a study. It is the `number`th of `count` steps, from 1. `minutes`
    are the duration of a trial run, or the minimum of a break, 0 if unlimited, of which some were
    `over` when it was sent. Without `guidance` or `tutorial` the simulator's settings apply, and
    without amounts of `skin` the scenario's. Its `name`, such as `desktop/2/task-3`, is stored.
    What it `allows` counts although it is not how a trainee plays (`Allowance`).
    """

    trainee: str
    kind: Annotated[str, one_of(*protocol.StepKind, ALL_DONE, FREE, REPEAT)]
    number: Annotated[int, whole_number(1, 100_000)] = 0
    count: Annotated[int, whole_number(1, 100_000)] = 0
    task: str = ""
    mode: AnyMode = ""
    questionnaire: str = ""
    minutes: _Minutes = 0.0
    over: _Minutes = field(default=0.0, compare=False)
    guidance: GuidanceRule = ""
    ghost: GhostChoice = ""
    procedure: Annotated[str, text(40, 0)] = ""
    tutorial: TutorialChoice = ""
    method: PlayedMethod = FIDUCIALS
    skin: Skin = field(default_factory=dict, hash=False)
    name: Annotated[str, text(160)] = ""
    allows: Allowances = ()

    @property
    def is_played(self) -> bool:
        kinds = protocol.StepKind
        return self.kind in (kinds.TRIAL, kinds.TRIAL_RUN, kinds.DECIDE)

    def left_s(self, passed_s: float = 0.0) -> float:
        """Return the remaining time in s, `passed_s` after it was sent."""
        return max(0.0, 60.0 * (self.minutes - self.over) - passed_s)

    def is_played_on(self, shift_mm: float, indentation_mm: float) -> bool:
        """Return whether a trial on such skin is the step's; the scenario's may be any."""
        amounts = tuple(self.skin.get(key, 0.0) for key in SKIN_KEYS)
        return not self.skin or amounts == (shift_mm, indentation_mm)


@dataclass(frozen=True)
class Assignment:
    """A task of a curriculum that is played until a goal is reached.

    An empty `scenario` or `mode` stands for any. The score of the `procedure` counts, or without
    one the score of the touches. For a goal by scores, so many `trials` in a row have to reach the
    `mark`, by default the pass mark of the study. It opens once the tasks in `after` are reached.
    """

    name: _Name
    task: _Name
    scenario: _Name = ""
    mode: AnyMode = ""
    method: PlayedMethod = FIDUCIALS
    procedure: _Name = ""
    goal: protocol.GoalKind = protocol.GoalKind.SCORE
    trials: Annotated[int, whole_number(1, protocol.MAX_GOAL_TRIALS)] = 1
    mark: Annotated[float | None, number(1, 100)] = None
    after: Annotated[tuple[str, ...], texts(0, protocol.MAX_GATES)] = ()

    def __post_init__(self) -> None:
        if self.task == TRIAL_RUN:
            raise InputError(
                f"The assignment {self.name}: task must be a task that is scored; the trial run is "
                "not."
            )
        if self.goal is protocol.GoalKind.COMPETENT and self.trials > 1:
            raise InputError(
                f"The assignment {self.name}: trials must be left out of the goal competent."
            )

    def is_played_as(
        self, scenario: str, task: str, mode: str, method: str, procedure: str
    ) -> bool:
        """Return whether the assignment accepts a trial of this kind; a drill has no method."""
        return (
            self.scenario in ("", scenario)
            and self.mode in ("", mode)
            and (self.task, self.procedure) == (task, procedure)
            and method in ("", self.method)
        )


@dataclass(frozen=True)
class AssignmentStanding(Assignment):
    """An assignment, and a trainee's standing in it.

    So many trials in a row pass now (`done`), or percent of the way to competence, of `needed`.
    `played` counts aborted trials, too. The latest scores have this `mean`, and the part `weakest`
    cost most in them. It waits for the assignments in `missing`. `reached_utc` is the start of
    the trial by which it was reached, or of a gate's where that was later.
    """

    goal: protocol.GoalKind = field(kw_only=True)
    state: protocol.AssignmentState = field(kw_only=True)
    needed: Annotated[int, whole_number(1, 100)] = field(kw_only=True)
    done: Annotated[int, whole_number(0, 100)] = 0
    played: Annotated[int, whole_number(0, 1_000_000)] = 0
    mean: Annotated[float | None, number(0, 100)] = None
    missing: Annotated[tuple[str, ...], texts(0, protocol.MAX_GATES)] = ()
    weakest: Annotated[str, text(20)] = ""
    reached_utc: str = ""


@dataclass(frozen=True)
class CurriculumMessage:
    """A trainee's standing in a curriculum, as the menu shows it: what to practice `next`."""

    trainee: str
    title: Annotated[str, text(80)] = ""
    next: Annotated[str, text(40)] = ""
    assignments: Annotated[
        tuple[AssignmentStanding, ...], list_of(0, protocol.MAX_ASSIGNMENTS, "assignments")
    ] = ()

    def find(self, name: str) -> AssignmentStanding | None:
        return next((each for each in self.assignments if each.name == name), None)
