"""The next step of a trainee (`StudyStep`), and answers to it (`StepAnswered`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import datetime
from pathlib import Path
from typing import Any

from rastrainer.files.json_fields import Fields
from rastrainer.protocol import ALL_DONE, FREE, REPEAT, RegistrationMethod, StepKind
from rastrainer.study.protocol.progress import Progress
from rastrainer.study.protocol.questionnaires import find_questionnaire


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
    def of(cls, trainee: str, progress: Progress, now: datetime) -> StudyStep:
        """Return the next step of a trainee with this progress."""
        step, count = progress.next_step, len(progress.steps)
        if step is None:
            return cls(trainee, ALL_DONE, count, count)
        return cls(
            trainee=trainee,
            kind=REPEAT if progress.unexplained else step.kind.value,
            number=len(progress.entries) + 1,
            count=count,
            task=step.task,
            mode=step.mode,
            questionnaire=step.questionnaire,
            minutes=step.minutes,
            over=min(progress.minutes_over(now), step.minutes),
            guidance=step.guidance,
            ghost=step.ghost,
            procedure=step.procedure,
            tutorial=step.tutorial,
            method="" if step.method == RegistrationMethod.FIDUCIALS.value else step.method,
            skin=step.skin,
        )

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> StudyStep:
        """Return the step in checked command arguments."""
        return cls(**arguments)

    @property
    def is_played(self) -> bool:
        """Whether it is a trial or trial run."""
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
        """Return the answers in a JSON object.

        Raises:
            InputError: it does not have one allowed answer for each item.
        """
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
        """Return the JSON object that `from_json` reads."""
        return asdict(self) | {"answers": list(self.answers)}

    def belong_to(self, step: StudyStep) -> bool:
        """Return whether these are answers to a step."""
        answered = (self.trainee, self.number, self.questionnaire)
        return answered == (step.trainee, step.number, step.questionnaire)
