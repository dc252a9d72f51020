"""What a study that Slicer leads asks of each trainee: the trainee's menu begins nothing else."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import replace

from rastrainer.protocol import FREE, StepKind
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES
from rastrainer.study.protocol.steps import StepAnswers, StudyStep
from rastrainer_simulator.texts.texts import Texts

MAX_TRAINEES = 1000
"""Of whom steps are kept; the oldest is forgotten first."""

PLAYED, ANSWERED = "played", "answered"
"""In place of a step's kind: it was done here, and Slicer will say what comes next."""


class StudySteps:
    """Keeps the next step of each trainee; a trainee without one practices freely.

    Nothing of it outlives the process: Slicer, which keeps the study, sends everything again once
    it is connected. Answers that it has not received by then are asked for again.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._steps: dict[str, StudyStep] = {}
        self._received_at: dict[str, float] = {}
        self._answers: dict[str, StepAnswers] = {}

    def take(self, step: StudyStep) -> None:
        """Take a step that Slicer sends."""
        name = step.trainee
        answers = self._answers.get(name)
        if answers is not None and not answers.belong_to(step):
            del self._answers[name]
        self._steps.pop(name, None)
        if step.kind != FREE:
            self._steps[name] = replace(step, kind=ANSWERED) if name in self._answers else step
            self._received_at[name] = self._clock()
        if len(self._steps) > MAX_TRAINEES:
            self._forget(next(iter(self._steps)))

    def step_of(self, trainee: str) -> StudyStep | None:
        """Return what comes next for a trainee; None for who practices freely."""
        return self._steps.get(trainee)

    def break_left_s(self, trainee: str) -> float:
        """Return how long the trainee's break still lasts, in s; 0 for who has none."""
        step = self._steps.get(trainee)
        if step is None or step.kind != StepKind.BREAK:
            return 0.0
        return step.left_s(self._clock() - self._received_at[trainee])

    def note_registered(self, trainee: str, task: str, mode: str) -> None:
        """Take note of a trial: what the study has asked for is not begun twice."""
        step = self._steps.get(trainee)
        wanted = (StepKind.TRIAL.value, task, mode)
        if step is not None and (step.kind, step.task, step.mode) == wanted:
            self._steps[trainee] = replace(step, kind=PLAYED)

    def answer(self, trainee: str, answers: Sequence[int]) -> None:
        """Keep the answers of the questionnaire that comes next, until Slicer has taken them.

        Raises:
            InputError: an answer is missing or none that it allows.
        """
        step = self._steps.get(trainee)
        if step is not None and step.kind == StepKind.QUESTIONNAIRE:
            step_data = {"number": step.number, "questionnaire": step.questionnaire}
            self._answers[trainee] = StepAnswers.from_json(
                {"trainee": trainee, "answers": list(answers), **step_data}
            )
            self._steps[trainee] = replace(step, kind=ANSWERED)

    def unacknowledged_answers(self) -> tuple[StepAnswers, ...]:
        """Return the answers that Slicer has not acknowledged."""
        return tuple(self._answers.values())

    def _forget(self, trainee: str) -> None:
        for kept in (self._steps, self._received_at, self._answers):
            kept.pop(trainee, None)


def step_sentence(texts: Texts, step: StudyStep, task_title: str, left: str) -> str:
    """Return the sentence about a step; `left` is the time that a break still lasts."""
    asked = QUESTIONNAIRES.get(step.questionnaire)
    by = f"study.by {step.method}"
    return texts.say(
        f"study.{step.kind}",
        number=step.number,
        count=step.count,
        task=f"{task_title} {texts.say(by)}" if by in texts else task_title,
        mode=texts.say(f"study.{step.mode}") if step.mode else "",
        minutes=step.minutes,
        left=left,
        questionnaire=step.questionnaire if asked is None else asked.title,
    )
