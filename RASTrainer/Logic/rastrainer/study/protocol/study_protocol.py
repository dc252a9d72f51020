"""The protocol of a study: its file, and the steps of each trainee in order."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Annotated, Any, ClassVar, Literal

from rastrainer.errors import InputError
from rastrainer.json_checks import is_identifier, number, one_of, text, texts, whole_number
from rastrainer.protocol import DECIDE, SKIN_KEYS, TRIAL_RUN, Mode, RegistrationMethod, StepKind
from rastrainer.study.protocol.plan_file import PlanFile
from rastrainer.study.protocol.questionnaires import find_questionnaire
from rastrainer.study_messages import (
    FIDUCIALS,
    GhostChoice,
    GuidanceRule,
    PlayedMethod,
    StudyStep,
    TutorialChoice,
    identifier,
    skin_amounts,
)
from rastrainer.trial.how_played import Allowance
from rastrainer.trial.scoring import PASS_MARK, SCORE_VERSION, ScoreReference

FIXED, BALANCED = "fixed", "balanced"
BEFORE_ALL, BEFORE_MODE, AFTER_TASK, AFTER_MODE, AFTER_ALL = OCCASIONS = (
    "before-all",
    "before-mode",
    "after-task",
    "after-mode",
    "after-all",
)
MAX_STEPS = 1000
_MODES = tuple(mode.value for mode in Mode)
_ALLOWANCES = tuple(each.value for each in Allowance)


def _questionnaire(value: Any) -> str:
    try:
        return find_questionnaire(text(40)(value)).name
    except InputError as error:
        raise ValueError(f"a questionnaire ({error})") from None


def _skin(value: Any) -> dict[str, float]:
    return dict.fromkeys(SKIN_KEYS, 0.0) | skin_amounts(value)


@dataclass(frozen=True)
class ScheduledQuestionnaire:
    """A questionnaire, its occasion, and its modes (empty for all)."""

    name: Annotated[str, _questionnaire]
    when: Annotated[str, one_of(*OCCASIONS)]
    modes: Annotated[tuple[str, ...], texts(0, len(_MODES), _MODES)] = ()

    def __post_init__(self) -> None:
        if self.modes and self.when in (BEFORE_ALL, AFTER_ALL):
            raise InputError(
                f"The questionnaire {self.name}: modes must be empty, since {self.when} belongs "
                "to no mode."
            )


@dataclass(frozen=True)
class StudyProtocol(PlanFile):
    """What every trainee of a study does.

    Attributes:
        drills: Occasions of a drill of decisions, each after its questionnaires. Before and after
            all, it is done in the first of the `modes`, so that it can be compared.
        trial_run_min: Length of the trial run at the start of each mode; 0 for none.
        references: Of the score, by task; by default, the scenario's.
        guidance, tutorial: "" leaves it to the simulator's setting.
        ghost: For the trials; "" for none, even if the simulator's setting has one.
        procedures: By task, the procedure that its trials continue with; without one, a trial ends
            with the registration.
        methods: By task, by what its trials are registered; without one, by its fiducials.
        skin: By task, how far the skin shifts and is indented in its trials; without one, as the
            scenario says.
        check_journals: Whether a trial is scored only if it follows from its journal.
    """

    WHAT = "The protocol"
    VERSIONS: ClassVar = {"formatVersion": 1, "scoreVersion": SCORE_VERSION}
    """A study started with an earlier one continues with the present; each score holds its own."""
    name: Annotated[str, identifier]
    title: Annotated[str, text(120)]
    modes: Annotated[tuple[str, ...], texts(1, len(_MODES), _MODES)]
    mode_order: Literal["fixed", "balanced"]
    tasks: Annotated[tuple[str, ...], texts(1, 20)]
    task_order: Literal["fixed", "balanced"]
    repetitions: Annotated[int, whole_number(1, 50)] = 1
    trial_run_min: Annotated[float, number(0, 120, "min")] = 0.0
    break_between_modes_min: Annotated[float, number(0, 30 * 24 * 60, "min")] = 0.0
    break_between_tasks_min: Annotated[float, number(0, 24 * 60, "min")] = 0.0
    questionnaires: tuple[ScheduledQuestionnaire, ...] = ()
    drills: Annotated[tuple[str, ...], texts(0, len(OCCASIONS), OCCASIONS)] = ()
    references: Mapping[str, ScoreReference] = field(default_factory=dict)
    pass_mark: Annotated[float | None, number(1, 100)] = None
    guidance: GuidanceRule = ""
    ghost: GhostChoice = ""
    tutorial: TutorialChoice = ""
    procedures: Mapping[str, Annotated[str, identifier]] = field(default_factory=dict)
    methods: Mapping[str, PlayedMethod] = field(default_factory=dict)
    skin: Mapping[str, Annotated[Mapping[str, float], _skin]] = field(default_factory=dict)
    allows: Annotated[tuple[str, ...], texts(0, len(_ALLOWANCES), _ALLOWANCES)] = ()
    check_journals: bool = True

    def __post_init__(self) -> None:
        tasks = ", ".join(self.tasks)
        for task in self.tasks:
            if task in (TRIAL_RUN, DECIDE) or not is_identifier(task):
                raise InputError(
                    "The protocol: tasks must be names of tasks, such as task-1; the trial run and "
                    "the drill of decisions are none."
                )
        for key in ("references", "procedures", "methods", "skin"):
            for task in getattr(self, key):
                if task not in self.tasks and (key, task) != ("references", TRIAL_RUN):
                    raise InputError(
                        f"The protocol: {key}.{task[:40]} must be one of the study's tasks, "
                        f"{tasks}."
                    )
        for asked in self.questionnaires:
            if not set(asked.modes) <= set(self.modes):
                raise InputError(
                    f"The protocol: questionnaires must have modes of {', '.join(self.modes)}."
                )
        if len(self.modes) * len(self.tasks) * self.repetitions > MAX_STEPS:
            raise InputError(
                f"The protocol: repetitions must be so few that there are at most {MAX_STEPS} "
                "trials."
            )


def pass_mark_of(
    protocol: StudyProtocol | None, method: str, is_procedure: bool = False
) -> float | None:
    """Return the pass mark of a study for trials by a method, or for procedures.

    The default holds for all. A protocol's mark was made of trials registered by fiducials: there
    is none for the others.
    """
    if protocol is None or protocol.pass_mark is None:
        return PASS_MARK
    is_meant = method == RegistrationMethod.FIDUCIALS and not is_procedure
    return protocol.pass_mark if is_meant else None


def protocol_text(protocol: StudyProtocol) -> str:
    return json.dumps(protocol.to_json(), indent=2, ensure_ascii=False) + "\n"


def steps_for(protocol: StudyProtocol, place: int) -> tuple[StudyStep, ...]:
    """Return the steps of the trainee at a place, from 0; their trainee is "" here."""
    steps = tuple(_steps(protocol, place))
    return tuple(
        replace(step, number=number, count=len(steps)) for number, step in enumerate(steps, start=1)
    )


def mode_order(protocol: StudyProtocol, place: int) -> tuple[str, ...]:
    return _ordered(protocol.modes, protocol.mode_order, place)


def _ordered(names: tuple[str, ...], order: str, row: int) -> tuple[str, ...]:
    if order != BALANCED:
        return names
    design = williams_design(len(names))
    return tuple(names[index] for index in design[row % len(design)])


def _steps(protocol: StudyProtocol, place: int) -> Iterator[StudyStep]:
    yield from _occasion(protocol, BEFORE_ALL, "", "before-all")
    for index, mode in enumerate(mode_order(protocol, place)):
        if index and protocol.break_between_modes_min:
            minutes = protocol.break_between_modes_min
            yield StudyStep("", StepKind.BREAK, name=f"{mode}/break", minutes=minutes)
        yield from _in_mode(protocol, place, index, mode)
    yield from _occasion(protocol, AFTER_ALL, "", "after-all")


def _in_mode(protocol: StudyProtocol, place: int, index: int, mode: str) -> Iterator[StudyStep]:
    yield from _occasion(protocol, BEFORE_MODE, mode, f"{mode}/before")
    if protocol.trial_run_min:
        yield StudyStep(
            "",
            StepKind.TRIAL_RUN,
            name=f"{mode}/{TRIAL_RUN}",
            mode=mode,
            task=TRIAL_RUN,
            minutes=protocol.trial_run_min,
            guidance=protocol.guidance,
            tutorial=protocol.tutorial,
        )
    is_first = True
    orders = len(williams_design(len(protocol.modes))) if protocol.mode_order == BALANCED else 1
    for round_ in range(protocol.repetitions):
        row = place // orders + index * protocol.repetitions + round_
        for task in _ordered(protocol.tasks, protocol.task_order, row):
            name = f"{mode}/{round_ + 1}/{task}"
            if not is_first and protocol.break_between_tasks_min:
                minutes = protocol.break_between_tasks_min
                pause = f"{name}/break"
                yield StudyStep("", StepKind.BREAK, name=pause, mode=mode, minutes=minutes)
            is_first = False
            yield StudyStep(
                "",
                StepKind.TRIAL,
                name=name,
                mode=mode,
                task=task,
                guidance=protocol.guidance,
                ghost=protocol.ghost,
                procedure=protocol.procedures.get(task, ""),
                method=protocol.methods.get(task, FIDUCIALS),
                skin=protocol.skin.get(task, {}),
                allows=protocol.allows,
            )
            yield from _occasion(protocol, AFTER_TASK, mode, name)
    yield from _occasion(protocol, AFTER_MODE, mode, f"{mode}/after")


def _occasion(
    protocol: StudyProtocol, occasion: str, mode: str, prefix: str
) -> Iterator[StudyStep]:
    """Yield the questionnaires of an occasion, then its drill."""
    for asked in protocol.questionnaires:
        if asked.when == occasion and (not asked.modes or mode in asked.modes):
            name = f"{prefix}/{asked.name}"
            kind = StepKind.QUESTIONNAIRE
            yield StudyStep("", kind, name=name, mode=mode, questionnaire=asked.name)
    if occasion in protocol.drills:
        mode, name = mode or protocol.modes[0], f"{prefix}/{DECIDE}"
        yield StudyStep("", StepKind.DECIDE, name=name, mode=mode, task=DECIDE)


def williams_design(count: int) -> tuple[tuple[int, ...], ...]:
    """Return the rows of a balanced Latin square of conditions 0 … count − 1.

    Over all rows, every condition is equally often at every position and after every other
    condition. An odd count needs twice as many rows: the square and its mirror image.
    """
    # 0, 1, n − 1, 2, n − 2, …
    first = [(place + 1) // 2 if place % 2 else -place // 2 for place in range(count)]
    square = [tuple((value + row) % count for value in first) for row in range(count)]
    if count % 2:
        square += [row[::-1] for row in square]
    return tuple(square)
