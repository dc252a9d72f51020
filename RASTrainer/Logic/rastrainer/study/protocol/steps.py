"""Instructions for steps of a study, objections to trials, and answers to questionnaires.

Slicer sends the next step (`StudyStep`); the simulator answers (`StepAnswered`).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from rastrainer.json_checks import list_of, whole_number
from rastrainer.protocol import Guidance, StepKind
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES, find_questionnaire
from rastrainer.study_messages import StudyStep
from rastrainer.trial import wording
from rastrainer.trial.record import TrialRecord

FIXED_GUIDANCE = tuple(each.value for each in Guidance if each is not Guidance.FADING)
MAX_STEPS = 100_000


def objections_to(step: StudyStep, record: TrialRecord) -> tuple[str, ...]:
    """Return why a trial of a step's task and mode does not count all the same, in words."""
    found = () if record.played is None else record.played.objections(step.mode, step.allows)
    ghost, guidance = record.display.get("ghost", ""), record.display.get("guidance", "")
    if ghost and ghost != step.ghost:
        found = (*found, f"the ghost {ghost!r} was shown")
    if guidance and step.guidance in FIXED_GUIDANCE and guidance != step.guidance:
        found = (*found, f"the guidance was {guidance!r}, not {step.guidance!r}")
    return found


def instruction(step: StudyStep) -> str:
    if step.kind == StepKind.QUESTIONNAIRE:
        return f"Answer the questionnaire {QUESTIONNAIRES[step.questionnaire].title}."
    if step.kind == StepKind.BREAK:
        return f"Take a break of at least {step.minutes:g} minutes."
    where = f" {wording.IN_MODE[step.mode]}" if step.mode else ""
    if step.kind == StepKind.DECIDE:
        return f"Do the drill of decisions{where}."
    if step.kind == StepKind.TRIAL_RUN:
        return f"Get to know the trial run{where} for {step.minutes:g} minutes."
    return f"Play {trial_title(step.task, step.mode, step.method, step.procedure)}."


def trial_title(task: str, mode: str, method: str, procedure: str) -> str:
    """Return the title of such a trial, such as "Task 3 by a trace over the skin"; "" is any."""
    words = (
        task.replace("-", " ").capitalize(),
        wording.BY_METHOD.get(method),
        f"with the procedure {procedure}" if procedure else "",
        wording.IN_MODE.get(mode),
    )
    return " ".join(filter(None, words))


@dataclass(frozen=True)
class StepAnswers:
    """The answers to the questionnaire of a step, one for each item, in order."""

    trainee: str
    number: Annotated[int, whole_number(1, MAX_STEPS)]
    questionnaire: str
    answers: Annotated[tuple[Annotated[int, whole_number(0, 100)], ...], list_of(0, 100)]

    def __post_init__(self) -> None:
        find_questionnaire(self.questionnaire).checked(self.answers)

    def belong_to(self, step: StudyStep) -> bool:
        answered = (self.trainee, self.number, self.questionnaire)
        return answered == (step.trainee, step.number, step.questionnaire)
