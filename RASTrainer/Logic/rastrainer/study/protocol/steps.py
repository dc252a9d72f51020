"""The steps of a trainee through a study, in order; the next one as a message, and its answers.

Slicer sends the next step (`StudyStep`); the simulator answers (`StepAnswered`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from rastrainer.files.json_fields import Fields
from rastrainer.protocol import (
    FREE,
    TRIAL_RUN,
    Guidance,
    Mode,
    RegistrationMethod,
    StepKind,
)
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES, find_questionnaire
from rastrainer.study.protocol.study_protocol import (
    AFTER_ALL,
    AFTER_MODE,
    AFTER_TASK,
    BALANCED,
    BEFORE_ALL,
    BEFORE_MODE,
    StudyProtocol,
)
from rastrainer.trial.record import TrialRecord

FIXED_GUIDANCE = tuple(each.value for each in Guidance if each is not Guidance.FADING)
_IN_MODE = {Mode.DESKTOP.value: "on the desktop screen", Mode.HMD.value: "with the headset"}

_BY_METHOD = {
    RegistrationMethod.LANDMARKS.value: " by landmarks of the face",
    RegistrationMethod.SURFACE.value: " by a trace over the skin",
    RegistrationMethod.LANDMARKS_SURFACE.value: " by landmarks and a trace",
}


@dataclass(frozen=True)
class Step:
    """One step.

    Attributes:
        name: Unique for the trainee, such as `desktop/2/task-3`; it is stored.
        kind: Of the step.
        mode: Display mode; "" if none.
        task: To be played; "" if none.
        round: Of the task in this mode, from 1; 0 if none.
        questionnaire: To be answered; "" if none.
        minutes: Duration of a trial run, or minimum of a break; 0 if unlimited.
        guidance: A `Guidance` to the next point; "" for the simulator's setting.
        ghost: A `GhostRule` for a trial; "" for none.
        tutorial: A `TutorialRule` for a trial run; "" for the simulator's setting.
        procedure: That the trial continues with; "" for the touches alone.
        method: By what the trial is registered, a `PLAYED_METHODS`.
        skin: How far the skin shifts and is indented; empty for what the scenario says.
        allows: `Allowance`s of the protocol.
    """

    name: str
    kind: StepKind
    mode: str = ""
    task: str = ""
    round: int = 0
    questionnaire: str = ""
    minutes: float = 0.0
    guidance: str = ""
    ghost: str = ""
    tutorial: str = ""
    procedure: str = ""
    method: str = RegistrationMethod.FIDUCIALS.value
    skin: Mapping[str, float] = field(default_factory=dict, hash=False)
    allows: tuple[str, ...] = ()

    def is_played_on(self, shift_mm: float, indentation_mm: float) -> bool:
        """Return whether a trial on such skin is the step's; the scenario's may be any."""
        return not self.skin or tuple(self.skin.values()) == (shift_mm, indentation_mm)

    def objections(self, record: TrialRecord) -> tuple[str, ...]:
        """Return why a trial of its task and mode does not count all the same, in words."""
        found = () if record.played is None else record.played.objections(self.mode, self.allows)
        ghost, guidance = record.display.get("ghost", ""), record.display.get("guidance", "")
        if ghost and ghost != self.ghost:
            found = (*found, f"the ghost {ghost!r} was shown")
        if guidance and self.guidance in FIXED_GUIDANCE and guidance != self.guidance:
            found = (*found, f"the guidance was {guidance!r}, not {self.guidance!r}")
        return found

    @property
    def sentence(self) -> str:
        """The instruction for the trainee."""
        if self.kind is StepKind.QUESTIONNAIRE:
            return f"Answer the questionnaire {QUESTIONNAIRES[self.questionnaire].title}."
        if self.kind is StepKind.BREAK:
            return f"Take a break of at least {self.minutes:g} minutes."
        if self.kind is StepKind.TRIAL_RUN:
            where = f" {_IN_MODE[self.mode]}" if self.mode else ""
            return f"Get to know the trial run{where} for {self.minutes:g} minutes."
        return f"Play {trial_title(self.task, self.mode, self.method, self.procedure)}."


def trial_title(task: str, mode: str, method: str, procedure: str) -> str:
    """Return the title of such a trial, such as "Task 3 by a trace over the skin"; "" is any.

    Args:
        task: Its name.
        mode: Display mode; "" for any.
        method: By what it is registered; nothing is said of fiducials.
        procedure: That it continues with; "" for none.
    """
    name = task.replace("-", " ").capitalize()
    then = f" with the procedure {procedure}" if procedure else ""
    where = f" {_IN_MODE[mode]}" if mode else ""
    return f"{name}{_BY_METHOD.get(method, '')}{then}{where}"


def steps_for(protocol: StudyProtocol, place: int) -> tuple[Step, ...]:
    return tuple(_steps(protocol, place))


def mode_order(protocol: StudyProtocol, place: int) -> tuple[str, ...]:
    return _ordered(protocol.modes, protocol.mode_order, place)


def task_order(
    protocol: StudyProtocol, place: int, mode_index: int, round_: int
) -> tuple[str, ...]:
    rows = len(williams_design(len(protocol.modes))) if protocol.mode_order == BALANCED else 1
    row = place // rows + mode_index * protocol.repetitions + round_
    return _ordered(protocol.tasks, protocol.task_order, row)


def _ordered(names: tuple[str, ...], order: str, row: int) -> tuple[str, ...]:
    if order != BALANCED:
        return names
    design = williams_design(len(names))
    return tuple(names[index] for index in design[row % len(design)])


def _steps(protocol: StudyProtocol, place: int) -> Iterator[Step]:
    yield from _questions(protocol, BEFORE_ALL, "", "before-all")
    for index, mode in enumerate(mode_order(protocol, place)):
        if index and protocol.break_between_modes_min:
            minutes = protocol.break_between_modes_min
            yield Step(f"{mode}/break", StepKind.BREAK, minutes=minutes)
        yield from _in_mode(protocol, place, index, mode)
    yield from _questions(protocol, AFTER_ALL, "", "after-all")


def _in_mode(protocol: StudyProtocol, place: int, index: int, mode: str) -> Iterator[Step]:
    yield from _questions(protocol, BEFORE_MODE, mode, f"{mode}/before")
    if protocol.trial_run_min:
        yield Step(
            f"{mode}/{TRIAL_RUN}",
            StepKind.TRIAL_RUN,
            mode,
            TRIAL_RUN,
            minutes=protocol.trial_run_min,
            guidance=protocol.guidance,
            tutorial=protocol.tutorial,
        )
    is_first = True
    for round_ in range(protocol.repetitions):
        for task in task_order(protocol, place, index, round_):
            name = f"{mode}/{round_ + 1}/{task}"
            if not is_first and protocol.break_between_tasks_min:
                minutes = protocol.break_between_tasks_min
                yield Step(f"{name}/break", StepKind.BREAK, mode, minutes=minutes)
            is_first = False
            yield Step(
                name,
                StepKind.TRIAL,
                mode,
                task,
                round_ + 1,
                guidance=protocol.guidance,
                ghost=protocol.ghost,
                procedure=protocol.procedures.get(task, ""),
                method=protocol.methods.get(task, RegistrationMethod.FIDUCIALS.value),
                skin=protocol.skins.get(task, {}),
                allows=protocol.allows,
            )
            yield from _questions(protocol, AFTER_TASK, mode, name)
    yield from _questions(protocol, AFTER_MODE, mode, f"{mode}/after")


def _questions(protocol: StudyProtocol, occasion: str, mode: str, prefix: str) -> Iterator[Step]:
    for asked in protocol.questionnaires:
        if asked.occasion == occasion and (not asked.modes or mode in asked.modes):
            name = asked.questionnaire
            yield Step(f"{prefix}/{name}", StepKind.QUESTIONNAIRE, mode, questionnaire=name)


def williams_design(count: int) -> tuple[tuple[int, ...], ...]:
    """Return the rows of a balanced Latin square of conditions 0 … count − 1.

    Over all rows, every condition is equally often at every position and after every other one. An
    odd count needs twice as many rows: the square and its mirror image.
    """
    first = [0]
    low, high = 1, count - 1
    while len(first) < count:
        first.append(low if len(first) % 2 else high)
        low, high = (low + 1, high) if len(first) % 2 == 0 else (low, high - 1)
    square = [tuple((value + row) % count for value in first) for row in range(count)]
    if count % 2:
        square += [row[::-1] for row in square]
    return tuple(square)


@dataclass(frozen=True)
class StudyStep:
    """The next step of a trainee.

    Attributes:
        trainee: Pseudonym.
        kind: A `StepKind`, `REPEAT` if an aborted trial needs a reason, `ALL_DONE` after the last
            step, or `FREE` without a study.
        number: Of the step, from 1; 0 if none.
        count: Of all steps; 0 if none.
        task: To be played; "" if none.
        mode: Display mode; "" if none.
        questionnaire: To be answered; "" if none.
        minutes: Duration; 0 if unlimited.
        over: Minutes elapsed when sent; not compared, since a step is the same whenever it is sent.
        guidance: A `Guidance` to the next point; "" for the simulator's setting.
        ghost: A `GhostRule`; "" for none.
        procedure: To be carried out after the registration; "" for the touches alone.
        tutorial: A `TutorialRule` for a trial run; "" for the simulator's setting.
        method: By what the trial is registered, a `PLAYED_METHODS`; "" for its fiducials.
        skin: How far the skin shifts and is indented, as of `skin_amounts`; empty for what the
            scenario says.
    """

    trainee: str
    kind: str = FREE
    number: int = 0
    count: int = 0
    task: str = ""
    mode: str = ""
    questionnaire: str = ""
    minutes: float = 0.0
    over: float = field(default=0.0, compare=False)
    guidance: str = ""
    ghost: str = ""
    procedure: str = ""
    tutorial: str = ""
    method: str = ""
    skin: Mapping[str, float] = field(default_factory=dict, hash=False)

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> StudyStep:
        return cls(**arguments)

    @property
    def is_played(self) -> bool:
        return self.kind in (StepKind.TRIAL.value, StepKind.TRIAL_RUN.value)

    def left_s(self, passed_s: float = 0.0) -> float:
        """Return the remaining time in s, `passed_s` after it was sent."""
        return max(0.0, 60.0 * (self.minutes - self.over) - passed_s)

    def arguments(self) -> dict[str, Any]:
        """Return the command arguments, without empty ones."""
        return {name: value for name, value in asdict(self).items() if value not in ("", 0, {})}


MAX_STEPS = 100_000


@dataclass(frozen=True)
class StepAnswers:
    """The answers to a step.

    Attributes:
        trainee: Pseudonym.
        number: Of the step, from 1.
        questionnaire: Its name.
        answers: One for each item, in order.
    """

    trainee: str
    number: int
    questionnaire: str
    answers: tuple[int, ...]

    @classmethod
    def from_json(cls, value: Mapping[str, Any]) -> StepAnswers:
        """Return the answers in a JSON object."""
        fields = Fields(dict(value), Path("StepAnswered"))
        questionnaire = find_questionnaire(fields.text("questionnaire", 40))
        answers = value.get("answers")
        if not isinstance(answers, list):
            raise fields.error("answers", "a list of whole numbers")
        return cls(
            fields.text("trainee", 64),
            fields.whole_number("number", 1, MAX_STEPS),
            questionnaire.name,
            questionnaire.checked(answers),
        )

    def to_json(self) -> dict[str, Any]:
        return asdict(self) | {"answers": list(self.answers)}

    def belong_to(self, step: StudyStep) -> bool:
        answered = (self.trainee, self.number, self.questionnaire)
        return answered == (step.trainee, step.number, step.questionnaire)
