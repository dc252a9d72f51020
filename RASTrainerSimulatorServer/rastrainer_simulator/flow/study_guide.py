"""What a study that Slicer leads asks of each trainee: the trainee's menu begins nothing else."""

from __future__ import annotations

from dataclasses import replace

from rastrainer.experiment.study_step import StudyStep
from rastrainer.protocol import FREE, StepKind
from rastrainer.questionnaires.catalog import QUESTIONNAIRES
from rastrainer_simulator.texts.texts import Texts

MOST_TRAINEES = 1000
"""Of whom steps are kept; the oldest news is forgotten first."""

PLAYED = "played"
"""In place of a step's kind: its trial is registered, and Slicer will tell what comes after it."""


class StudyGuide:
    """Keeps the last news of each trainee; whoever is not told of practices freely."""

    def __init__(self) -> None:
        self._steps: dict[str, StudyStep] = {}

    def take(self, step: StudyStep) -> None:
        """Take note of what Slicer tells."""
        self._steps.pop(step.trainee, None)
        if step.kind != FREE:
            self._steps[step.trainee] = step
        if len(self._steps) > MOST_TRAINEES:
            del self._steps[next(iter(self._steps))]

    def step_of(self, trainee: str) -> StudyStep | None:
        """Return what comes next for a trainee; None for who practices freely."""
        return self._steps.get(trainee)

    def note_registered(self, trainee: str, task: str, mode: str) -> None:
        """Take note of a trial: what the study has asked for is not begun twice."""
        step = self._steps.get(trainee)
        wanted = (StepKind.TRIAL.value, task, mode)
        if step is not None and (step.kind, step.task, step.mode) == wanted:
            self._steps[trainee] = replace(step, kind=PLAYED)


def step_sentence(texts: Texts, step: StudyStep, task_title: str) -> str:
    """Return what the trainee is told of a step."""
    asked = QUESTIONNAIRES.get(step.questionnaire)
    return texts.say(
        f"study.{step.kind}",
        number=step.number,
        count=step.count,
        task=task_title,
        mode=texts.say(f"study.{step.mode}") if step.mode else "",
        minutes=step.minutes,
        questionnaire=step.questionnaire if asked is None else asked.title,
    )
