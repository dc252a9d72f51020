"""A study's steps in words, answers to questionnaires, and a trainee's progress through the steps.

Slicer sends the next step (`StudyStep`); the simulator answers (`StepAnswered`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime, timedelta
from typing import Annotated, Any

from rastrainer.errors import InputError
from rastrainer.json_checks import is_number, list_of, whole_number
from rastrainer.protocol import ALL_DONE, REPEAT, Guidance, StepKind
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES, find_questionnaire
from rastrainer.study_messages import StudyStep
from rastrainer.trial import wording
from rastrainer.trial.record import AbortedTrial, TrialRecord

FIXED_GUIDANCE = tuple(each.value for each in Guidance if each is not Guidance.FADING)
MAX_STEPS = 100_000
DONE, SKIPPED = "done", "skipped"
MIN_REASON_LENGTH, MAX_REASON_LENGTH = 10, 500


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


@dataclass(frozen=True)
class StepEntry:
    """The outcome of a step, `done` or `skipped`.

    Attributes:
        details: `trialId` of a trial or a drill, `answers` of a questionnaire, `minutes` of a trial
            run or a break, `reason` of a skipped step.
    """

    step: str
    outcome: str
    details: Mapping[str, Any]
    stored_utc: str


@dataclass(frozen=True)
class StepProgress:
    """A trainee's steps and their outcomes.

    Attributes:
        entries: Of the first steps, in order.
        practiced_s: Time already practiced in the next step, if it is a trial run, in s.
        unexplained: Aborted trials of the next step; repeating it needs a reason.
    """

    steps: tuple[StudyStep, ...]
    entries: tuple[StepEntry, ...]
    enrolled_utc: str = ""
    practiced_s: float = 0.0
    unexplained: tuple[AbortedTrial, ...] = ()

    def __post_init__(self) -> None:
        done = [entry.step for entry in self.entries]
        if [step.name for step in self.steps[: len(done)]] != done:
            raise InputError(
                "The steps done so far do not match this protocol; use the protocol that the "
                "study was started with."
            )

    @property
    def next_step(self) -> StudyStep | None:
        return self.steps[len(self.entries)] if len(self.entries) < len(self.steps) else None

    @property
    def since_utc(self) -> str:
        """When the previous step was done, or the trainee enrolled; ISO 8601."""
        return self.entries[-1].stored_utc if self.entries else self.enrolled_utc

    def minutes_elapsed(self, now: datetime) -> float:
        if self.break_end is None:
            return self.practiced_s / 60.0
        return max(0.0, (now - datetime.fromisoformat(self.since_utc)).total_seconds() / 60.0)

    @property
    def practice_left_s(self) -> float:
        """Remaining time of a trial run, s; negative when over."""
        return 0.0 if self.next_step is None else 60.0 * self.next_step.minutes - self.practiced_s

    @property
    def break_end(self) -> datetime | None:
        """End of the next step if it is a break, else None."""
        step = self.next_step
        if step is None or step.kind != StepKind.BREAK:
            return None
        return datetime.fromisoformat(self.since_utc) + timedelta(minutes=step.minutes)

    @property
    def counted_trials(self) -> tuple[str, ...]:
        return tuple(e.details["trialId"] for e in self.entries if "trialId" in e.details)

    @property
    def skipped(self) -> tuple[StepEntry, ...]:
        return tuple(entry for entry in self.entries if entry.outcome == SKIPPED)

    @property
    def sentence(self) -> str:
        step = self.next_step
        if step is None:
            return "All steps of the study are done. Thank you!"
        return f"Step {len(self.entries) + 1} of {len(self.steps)}: {instruction(step)}"

    @property
    def repeat_sentence(self) -> str:
        """The request for a reason after an aborted trial; "" if none is needed."""
        if not self.unexplained:
            return ""
        last = self.unexplained[-1]
        return (
            f"This trial was aborted with {last.done}. It can be repeated only with a reason, "
            "which goes into the report."
        )

    def study_step(self, trainee: str, now: datetime) -> StudyStep:
        step, count = self.next_step, len(self.steps)
        if step is None:
            return StudyStep(trainee, ALL_DONE, count, count)
        over = min(self.minutes_elapsed(now), step.minutes)
        kind = REPEAT if self.unexplained else step.kind
        # What only the study needs stays here.
        return replace(step, trainee=trainee, kind=kind, over=over, name="", allows=())

    def check_start(self, mode: str, task: str) -> StudyStep:
        step = self.due()
        if not step.is_played or (step.mode, step.task) != (mode, task):
            raise InputError(f"Not yet: the study asks for something else first. {self.sentence}")
        if self.unexplained:
            raise InputError(self.repeat_sentence)
        return step

    def due(self, step_name: str = "") -> StudyStep:
        """Return the next step; raise `InputError` if it has another name than a given one."""
        step = self.next_step
        if step is None:
            raise InputError("All steps of the study are done; nothing comes after them.")
        if step_name not in ("", step.name):
            raise InputError(
                f"The next step is {step.name}, not {step_name[:80]}. Steps are done in "
                "order; to leave one out, skip it and give a reason."
            )
        return step


def checked_details(step: StudyStep, details: Mapping[str, Any]) -> dict[str, Any]:
    """Return the details to store when a step is done; raise `InputError` if incomplete."""
    if step.kind == StepKind.QUESTIONNAIRE:
        if "answers" not in details:
            raise InputError("A questionnaire is complete only with its answers.")
        questionnaire = find_questionnaire(step.questionnaire)
        return {"answers": list(questionnaire.checked(details["answers"]))}
    if step.kind in (StepKind.TRIAL, StepKind.DECIDE):
        what = "drill" if step.kind == StepKind.DECIDE else "trial"
        raise InputError(f"A step with a {what} is done by a stored {what} that counts for it.")
    minutes = details.get("minutes")
    if not is_number(minutes) or not step.minutes <= minutes < float("inf"):
        what = "The trial run" if step.kind == StepKind.TRIAL_RUN else "The break"
        took = f"{minutes:.1f}" if is_number(minutes) else "none"
        raise InputError(
            f"{what} takes {step.minutes:g} minutes, of which {took} have passed; to continue "
            "earlier, skip it and give a reason."
        )
    return {"minutes": float(minutes)}


def checked_reason(reason: Any, what: str) -> str:
    is_text = isinstance(reason, str) and reason.strip().isprintable()
    if not is_text or not MIN_REASON_LENGTH <= len(reason.strip()) <= MAX_REASON_LENGTH:
        raise InputError(
            f"{what} only with a reason of {MIN_REASON_LENGTH} to {MAX_REASON_LENGTH} characters; "
            "it goes into the report."
        )
    return reason.strip()
