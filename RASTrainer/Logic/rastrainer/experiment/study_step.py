"""What a study asks of a trainee next, as Slicer tells it to the simulator (`StudyStep`)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from datetime import datetime
from typing import Any

from rastrainer.experiment.progress import Progress
from rastrainer.protocol import ALL_DONE, FREE, REPEAT, StepKind


@dataclass(frozen=True)
class StudyStep:
    """The step that comes next for a trainee.

    Attributes:
        trainee: Pseudonym.
        kind: A `StepKind`, `REPEAT` where an aborted trial waits for a reason, `ALL_DONE` after
            the last step, or `FREE` where no study leads.
        number: Of the step, from 1; 0 where there is none.
        count: Of all steps; 0 where there are none.
        task: That is played; "" where none is.
        mode: In which it is done; "" for what belongs to none.
        questionnaire: That is asked; "" where none is.
        minutes: How long it takes; 0 where that is open.
        over: How many of these minutes are over when it is told. It goes on by itself, so that a
            step is the same step whenever it is told.
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

    @classmethod
    def of(cls, trainee: str, progress: Progress, now: datetime) -> StudyStep:
        """Return what comes next for a trainee who stands there."""
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
        )

    @classmethod
    def told(cls, arguments: Mapping[str, Any]) -> StudyStep:
        """Return what checked arguments of the command say."""
        return cls(**arguments)

    @property
    def is_played(self) -> bool:
        """Whether a trial or a trial run is started for it."""
        return self.kind in (StepKind.TRIAL.value, StepKind.TRIAL_RUN.value)

    def arguments(self) -> dict[str, Any]:
        """Return the arguments of the command; what is empty is left out."""
        return {name: value for name, value in asdict(self).items() if value not in ("", 0)}
