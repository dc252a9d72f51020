"""What Slicer has assigned to each trainee: the next step of a study, or a curriculum."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

from rastrainer.protocol import DECIDE, FREE, AssignmentState, GoalKind, StepKind
from rastrainer.study.protocol.steps import StepAnswers
from rastrainer.study_messages import FIDUCIALS, AssignmentStanding, CurriculumMessage, StudyStep
from rastrainer_simulator.texts.texts import Texts

MAX_TRAINEES = 1000
"""Trainees whose steps and curricula are remembered; the oldest is forgotten first."""

PLAYED, ANSWERED = "played", "answered"
"""In place of a step's kind: the step is done here, and Slicer will send the next."""


class AssignedTraining:
    """Keeps the next step of each trainee, and the standing in a curriculum.

    A trainee without a step practices freely. Nothing of it outlives the process: Slicer, which
    keeps the study, sends everything again once it is connected. Answers that it has not received
    by then are asked for again. A curriculum does not outlive the connection either: it may have
    ended by then.

    Attributes:
        answers: of each trainee to a questionnaire, until Slicer has acknowledged them.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.steps: dict[str, StudyStep] = {}
        self.answers: dict[str, StepAnswers] = {}
        self.curricula: dict[str, CurriculumMessage] = {}
        self._clock = clock
        self._received_at: dict[str, float] = {}

    def take_step(self, step: StudyStep) -> None:
        name = step.trainee
        answers = self.answers.get(name)
        if answers is not None and not answers.belong_to(step):
            del self.answers[name]
        self.steps.pop(name, None)
        if step.kind != FREE:
            self.steps[name] = replace(step, kind=ANSWERED) if name in self.answers else step
            self._received_at[name] = self._clock()
        if len(self.steps) > MAX_TRAINEES:
            oldest = next(iter(self.steps))
            for kept in (self.steps, self._received_at, self.answers):
                kept.pop(oldest, None)

    def take_curriculum(self, curriculum: CurriculumMessage) -> None:
        self.curricula.pop(curriculum.trainee, None)
        if curriculum.assignments:
            self.curricula[curriculum.trainee] = curriculum
        if len(self.curricula) > MAX_TRAINEES:
            del self.curricula[next(iter(self.curricula))]

    def break_left_s(self, trainee: str) -> float:
        step = self.steps.get(trainee)
        if step is None or step.kind != StepKind.BREAK:
            return 0.0
        return step.left_s(self._clock() - self._received_at[trainee])

    def note_registered(self, trainee: str, task: str, mode: str) -> None:
        step = self.steps.get(trainee)
        if step is None or step.kind not in (StepKind.TRIAL, StepKind.DECIDE):
            return
        if (step.task, step.mode) == (task, mode):
            self.steps[trainee] = replace(step, kind=PLAYED)

    def answer(self, trainee: str, answers: Sequence[int]) -> None:
        """Keep the answers to the questionnaire that comes next, until Slicer has received them."""
        step = self.steps.get(trainee)
        if step is not None and step.kind == StepKind.QUESTIONNAIRE:
            given = StepAnswers(trainee, step.number, step.questionnaire, tuple(answers))
            self.answers[trainee] = given
            self.steps[trainee] = replace(step, kind=ANSWERED)


Titles = Callable[[str], str]
"""Maps the name of a task or a procedure to its title."""


@dataclass(frozen=True)
class AssignmentTexts:
    """Describes assignments in the trainee's language."""

    texts: Texts
    task_title: Titles
    procedure_title: Titles

    def title(self, each: AssignmentStanding) -> str:
        by = f"study.by {each.method}"
        words = [self.task_title(each.task)]
        words += [self.texts.say(by)] if by in self.texts else []
        words += [self.texts.say(f"study.{each.mode}")] if each.mode else []
        trial = " ".join(words)
        if not each.procedure:
            return trial
        procedure = self.procedure_title(each.procedure)
        return self.texts.say("assignments.with procedure", trial=trial, procedure=procedure)

    def label(self, each: AssignmentStanding) -> str:
        """Return a short title for a row: the task, and the first that is special about it."""
        if each.procedure:
            special = self.procedure_title(each.procedure)
        elif each.method != FIDUCIALS:
            special = self.texts.say(f"method.{each.method}")
        else:
            special = self.texts.say(f"mode.{each.mode}") if each.mode else ""
        return " · ".join(filter(None, (self.task_title(each.task), special)))

    def progress(self, each: AssignmentStanding) -> str:
        if each.state is not AssignmentState.OPEN:
            return self.texts.say(f"assignments.{each.state.value}")
        key = "assignments.percent" if each.goal is GoalKind.COMPETENT else "assignments.count"
        return self.texts.say(key, done=each.done, needed=each.needed)

    def goal(self, each: AssignmentStanding) -> str:
        if not each.mark:
            return self.texts.say("assignments.no mark")
        if each.goal is GoalKind.COMPETENT:
            return self.texts.say("assignments.competent", mark=each.mark)
        kind = "drill" if each.task == DECIDE else "trial"
        key = f"assignments.one {kind}" if each.needed == 1 else f"assignments.{kind}s"
        return self.texts.say(key, needed=each.needed, mark=each.mark)

    def gate(self, curriculum: CurriculumMessage, each: AssignmentStanding) -> str:
        missing = [found for name in each.missing if (found := curriculum.find(name)) is not None]
        names = self.texts.listed(self.title(one) for one in missing) or "–"
        return self.texts.say("assignments.gate", assignments=names)

    def summary(self, curriculum: CurriculumMessage) -> str:
        return self.texts.say(
            "assignments.summary",
            reached=sum(each.state is AssignmentState.REACHED for each in curriculum.assignments),
            count=len(curriculum.assignments),
        )

    def in_brief(self, curriculum: CurriculumMessage) -> str:
        """Return what a teacher reads: how many are reached, and the progress of the next one."""
        best = curriculum.find(curriculum.next)
        if best is None:
            return self.summary(curriculum)
        label, progress = self.label(best), self.progress(best)
        following = self.texts.say("assignments.next in brief", assignment=label, progress=progress)
        return f"{self.summary(curriculum)} · {following}"

    def advice(self, curriculum: CurriculumMessage) -> str:
        best = curriculum.find(curriculum.next)
        if best is None:
            return self.texts.say("assignments.all reached")
        if not best.played:
            return self.texts.say("assignments.next unplayed", assignment=self.title(best))
        sentence = self.texts.say("assignments.next", assignment=self.title(best))
        part = f"assignments.part {best.weakest}"
        if part not in self.texts:
            return sentence
        return f"{sentence} {self.texts.say('assignments.weakest', part=self.texts.say(part))}"
