"""The protocol of a study and its file."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import Any, TypeVar

from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields, fields_of, read_fields
from rastrainer.head.trial_head import read_skin
from rastrainer.json_checks import is_identifier
from rastrainer.protocol import (
    PLAYED_METHODS,
    TRIAL_RUN,
    GhostRule,
    Guidance,
    Mode,
    RegistrationMethod,
    TutorialRule,
)
from rastrainer.study.protocol.questionnaires import find_questionnaire
from rastrainer.trial.how_played import Allowance
from rastrainer.trial.scoring import PASS_MARK, SCORE_VERSION, ScoreReference

FORMAT_VERSION = 1
FIXED, BALANCED = "fixed", "balanced"
BEFORE_ALL, BEFORE_MODE, AFTER_TASK, AFTER_MODE, AFTER_ALL = OCCASIONS = (
    "before-all",
    "before-mode",
    "after-task",
    "after-mode",
    "after-all",
)
MAX_STEPS = 1000
"""A study started with an earlier one continues with the present; each score holds its own."""
Value = TypeVar("Value")
_KEYS = (
    *("formatVersion", "name", "title", "modes", "modeOrder", "tasks", "taskOrder"),
    *("repetitions", "trialRun", "breaks", "questionnaires", "scoring"),
    *("guidance", "ghost", "tutorial", "procedures", "methods", "skin", "allows"),
    "checkJournals",
)


@dataclass(frozen=True)
class ScheduledQuestionnaire:
    """A questionnaire, its occasion, and its modes (empty for all)."""

    questionnaire: str
    occasion: str
    modes: tuple[str, ...] = ()


@dataclass(frozen=True)
class StudyProtocol:
    """What every trainee of a study does.

    Attributes:
        name: Short; `title` is for people.
        modes: Conditions, `desktop` and `hmd`.
        mode_order: `fixed` as listed, or `balanced` over the trainees.
        tasks: Names of the tasks.
        task_order: `fixed` or `balanced`.
        repetitions: How often each task is done in each mode, round by round.
        trial_run_min: Length of the trial run at the start of each mode, in min; 0 for none.
        break_between_modes_min: At least so long, in min; 0 for none.
        questionnaires: When each one is answered.
        references: Of the score, by task; a task without one has that of the scenario.
        pass_mark: Score that passes; None where the protocol sets none and the default holds.
        guidance: A `Guidance` to the next point; "" leaves it to the simulator's setting.
        ghost: A `GhostRule` for the trials; "" for none, whatever the simulator's setting.
        tutorial: A `TutorialRule`; "" leaves it to the simulator's setting.
        procedures: By task, the procedure that its trials continue with; without one, a trial ends
            with the registration.
        methods: By task, by what its trials are registered, a `PLAYED_METHODS`; without one, by its
            fiducials.
        skins: By task, how far the skin shifts and is indented in its trials, as of `skin_amounts`;
            without one, as the scenario says.
        allows: What counts in the trials although it is not how a trainee plays, `Allowance`s.
        checks_journals: Whether a trial is scored only if it follows from its journal.
    """

    name: str
    title: str
    modes: tuple[str, ...]
    mode_order: str
    tasks: tuple[str, ...]
    task_order: str
    repetitions: int = 1
    trial_run_min: float = 0.0
    break_between_modes_min: float = 0.0
    break_between_tasks_min: float = 0.0
    questionnaires: tuple[ScheduledQuestionnaire, ...] = ()
    references: Mapping[str, ScoreReference] = field(default_factory=dict)
    pass_mark: float | None = None
    guidance: str = ""
    ghost: str = ""
    tutorial: str = ""
    procedures: Mapping[str, str] = field(default_factory=dict)
    methods: Mapping[str, str] = field(default_factory=dict)
    skins: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    allows: tuple[str, ...] = ()
    checks_journals: bool = True

    def to_json(self) -> dict[str, Any]:
        """Return the object that the file holds."""
        mark = {} if self.pass_mark is None else {"passMark": self.pass_mark}
        chosen = {"guidance": self.guidance, "ghost": self.ghost, "tutorial": self.tutorial}
        by_task: dict[str, dict[str, Any]] = {
            "procedures": dict(self.procedures),
            "methods": dict(self.methods),
            "skin": {task: dict(skin) for task, skin in self.skins.items()},
        }
        return {
            "formatVersion": FORMAT_VERSION,
            "name": self.name,
            "title": self.title,
            "modes": list(self.modes),
            "modeOrder": self.mode_order,
            "tasks": list(self.tasks),
            **{name: value for name, value in chosen.items() if value},
            **{name: value for name, value in by_task.items() if value},
            **({"allows": list(self.allows)} if self.allows else {}),
            "checkJournals": self.checks_journals,
            "taskOrder": self.task_order,
            "repetitions": self.repetitions,
            "trialRun": {"minutes": self.trial_run_min},
            "breaks": {
                "betweenModesMinutes": self.break_between_modes_min,
                "betweenTasksMinutes": self.break_between_tasks_min,
            },
            "questionnaires": [
                {"name": asked.questionnaire, "when": asked.occasion, "modes": list(asked.modes)}
                for asked in self.questionnaires
            ],
            "scoring": {
                "version": SCORE_VERSION,
                **mark,
                "references": {
                    task: {"timeS": r.time_s, "treMm": r.tre_mm, "limitMm": r.limit_mm}
                    for task, r in self.references.items()
                },
            },
        }


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


def read_study_protocol(path: Path | str) -> StudyProtocol:
    """Read a protocol file."""
    return _protocol(read_fields(Path(path)))


def study_protocol_from_json(value: Any) -> StudyProtocol:
    """Return the protocol of a `to_json` object; raise `InputError` if invalid."""
    return _protocol(fields_of(value, "study protocol"))


def protocol_text(protocol: StudyProtocol) -> str:
    return json.dumps(protocol.to_json(), indent=2, ensure_ascii=False) + "\n"


def _protocol(fields: Fields) -> StudyProtocol:
    fields.check_names(_KEYS, "a protocol")
    fields.check_format(FORMAT_VERSION)
    name = fields.identifier("name")
    modes = fields.texts("modes", 1, len(Mode), choices=tuple(mode.value for mode in Mode))
    tasks = fields.texts("tasks", 1, 20)
    if not all(is_identifier(task) and task != TRIAL_RUN for task in tasks):
        raise fields.error("tasks", "names of tasks, such as task-1; the trial run is not one")
    breaks, scoring = fields.fields("breaks"), fields.fields("scoring")
    if scoring.text("version", 20) != SCORE_VERSION:
        raise scoring.error("version", f"{SCORE_VERSION}, the score that this version computes")
    protocol = StudyProtocol(
        name=name,
        title=fields.text("title", 120),
        modes=modes,
        mode_order=fields.one_of("modeOrder", (FIXED, BALANCED)),
        tasks=tasks,
        task_order=fields.one_of("taskOrder", (FIXED, BALANCED)),
        repetitions=fields.whole_number("repetitions", 1, 50),
        trial_run_min=fields.fields("trialRun").number("minutes", 0, 120),
        break_between_modes_min=breaks.number("betweenModesMinutes", 0, 30 * 24 * 60),
        break_between_tasks_min=breaks.number("betweenTasksMinutes", 0, 24 * 60),
        questionnaires=tuple(
            _questionnaire(entry, modes) for entry in fields.list_of_fields("questionnaires", 0, 20)
        ),
        references=_references(scoring.fields("references"), tasks),
        pass_mark=scoring.number("passMark", 1, 100) if "passMark" in scoring.names() else None,
        guidance=_chosen(fields, "guidance", Guidance),
        ghost=_chosen(fields, "ghost", GhostRule),
        tutorial=_chosen(fields, "tutorial", TutorialRule),
        procedures=_by_task(fields, "procedures", tasks, Fields.identifier),
        methods=_by_task(fields, "methods", tasks, _method),
        skins=_by_task(
            fields, "skin", tasks, lambda entries, task: read_skin(entries, task).amounts
        ),
        allows=_allowances(fields),
        checks_journals=fields.yes_or_no("checkJournals", True),
    )
    if len(modes) * len(tasks) * protocol.repetitions > MAX_STEPS:
        raise fields.error("repetitions", f"so few that there are at most {MAX_STEPS} trials")
    return protocol


def _chosen(fields: Fields, name: str, choices: type[Enum]) -> str:
    """Return the choice of a field, "" where it is left out."""
    if name not in fields.names():
        return ""
    return fields.one_of(name, tuple(choice.value for choice in choices))


def _allowances(fields: Fields) -> tuple[str, ...]:
    known = tuple(each.value for each in Allowance)
    given = "allows" in fields.names()
    return fields.texts("allows", 0, len(known), choices=known) if given else ()


def _by_task(
    fields: Fields, name: str, tasks: tuple[str, ...], read: Callable[[Fields, str], Value]
) -> dict[str, Value]:
    """Return an optional object from the study's tasks to what `read` finds for each."""
    if name not in fields.names():
        return {}
    entries = fields.fields(name)
    for task in entries.names():
        if task not in tasks:
            raise entries.error(task[:40], f"one of the study's tasks, {', '.join(tasks)}")
    return {task: read(entries, task) for task in entries.names()}


def _method(entries: Fields, task: str) -> str:
    return entries.one_of(task, tuple(method.value for method in PLAYED_METHODS))


def _questionnaire(entry: Fields, modes: tuple[str, ...]) -> ScheduledQuestionnaire:
    name = entry.text("name", 40)
    try:
        find_questionnaire(name)
    except InputError as error:
        raise entry.error("name", f"a questionnaire ({error})") from None
    occasion = entry.one_of("when", OCCASIONS)
    chosen = entry.texts("modes", 0, len(modes), choices=modes)
    if chosen and occasion in (BEFORE_ALL, AFTER_ALL):
        raise entry.error("modes", f"empty, since {occasion} belongs to no mode")
    return ScheduledQuestionnaire(name, occasion, chosen)


def _references(fields: Fields, tasks: tuple[str, ...]) -> dict[str, ScoreReference]:
    references = {}
    for task in fields.names():
        if task not in (*tasks, TRIAL_RUN):
            raise fields.error(task[:40], f"one of the study's tasks, {', '.join(tasks)}")
        entry = fields.fields(task)
        references[task] = ScoreReference(
            entry.number("timeS", 1, 1e4),
            entry.number("treMm", 0.01, 100),
            entry.number("limitMm", 0.01, 100),
        )
    return references
