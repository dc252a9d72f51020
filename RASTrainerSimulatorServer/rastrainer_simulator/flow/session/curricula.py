"""What trainees are to reach, as Slicer tells it, in the words that trainees read."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from rastrainer.study.curriculum.curriculum_message import AssignmentMessage, CurriculumMessage
from rastrainer_simulator.texts.texts import Texts

MAX_TRAINEES = 1000
"""Of whom curricula are kept; the oldest is forgotten first."""
Titles = Callable[[str], str]
"""From the name of a task or a procedure to what people call it."""


class Curricula:
    """Keeps where each trainee stands.

    Nothing of it outlives the connection: Slicer, which keeps the study, tells everything again
    once it is connected, and by then a curriculum may have ended, or the study be another.
    """

    def __init__(self) -> None:
        self._messages: dict[str, CurriculumMessage] = {}

    def take(self, curriculum: CurriculumMessage) -> None:
        """Take what Slicer tells of a trainee."""
        self._messages.pop(curriculum.trainee, None)
        if curriculum.assignments:
            self._messages[curriculum.trainee] = curriculum
        if len(self._messages) > MAX_TRAINEES:
            del self._messages[next(iter(self._messages))]

    def forget_all(self) -> None:
        """Forget everybody, when no Slicer is connected any more."""
        self._messages.clear()

    def of(self, trainee: str) -> CurriculumMessage | None:
        """Return where a trainee stands; None for who has no curriculum."""
        return self._messages.get(trainee)


def newly_reached(
    before: CurriculumMessage | None, now: CurriculumMessage | None
) -> Iterator[AssignmentMessage]:
    """Yield the assignments that a trainee has reached since Slicer told of them before."""
    if before is None or now is None or before is now or before.trainee != now.trainee:
        return
    for each in now.assignments:
        earlier = before.find(each.name)
        if each.is_reached and earlier is not None and not earlier.is_reached:
            yield each


class AssignmentTexts:
    """Says what assignments are, in the trainee's language."""

    def __init__(self, texts: Texts, task_title: Titles, procedure_title: Titles) -> None:
        self._say = texts.say
        self._texts = texts
        self._task_title = task_title
        self._procedure_title = procedure_title

    def title(self, each: AssignmentMessage) -> str:
        """Return what people call an assignment."""
        by = f"study.by {each.method}"
        words = [self._task_title(each.task)]
        words += [self._say(by)] if by in self._texts else []
        words += [self._say(f"study.{each.mode}")] if each.mode else []
        trial = " ".join(words)
        if not each.procedure:
            return trial
        procedure = self._procedure_title(each.procedure)
        return self._say("assignments.with procedure", trial=trial, procedure=procedure)

    def label(self, each: AssignmentMessage) -> str:
        """Return a short title for a row: the task, and the first that is special about it."""
        if each.procedure:
            special = self._procedure_title(each.procedure)
        elif f"method.{each.method}" in self._texts:
            special = self._say(f"method.{each.method}")
        else:
            special = self._say(f"mode.{each.mode}") if each.mode else ""
        title = self._task_title(each.task)
        return f"{title} · {special}" if special else title

    def progress(self, each: AssignmentMessage) -> str:
        """Return how far the trainee is, in few characters."""
        if each.is_reached:
            return self._say("assignments.reached")
        if each.is_locked:
            return self._say("assignments.locked")
        key = "assignments.percent" if each.is_by_competence else "assignments.count"
        return self._say(key, done=each.done, needed=each.needed)

    def goal(self, each: AssignmentMessage) -> str:
        """Return when an assignment is reached."""
        if not each.mark:
            return self._say("assignments.no mark")
        if each.is_by_competence:
            return self._say("assignments.competent", mark=each.mark)
        key = "assignments.one trial" if each.needed == 1 else "assignments.trials"
        return self._say(key, needed=each.needed, mark=each.mark)

    def gate(self, curriculum: CurriculumMessage, each: AssignmentMessage) -> str:
        """Return what a locked assignment waits for."""
        missing = [found for name in each.missing if (found := curriculum.find(name)) is not None]
        names = self._texts.listed(self.title(one) for one in missing) or "–"
        return self._say("assignments.gate", assignments=names)

    def summary(self, curriculum: CurriculumMessage) -> str:
        """Return how many assignments are reached."""
        return self._say(
            "assignments.summary", reached=curriculum.reached, count=len(curriculum.assignments)
        )

    def in_brief(self, curriculum: CurriculumMessage) -> str:
        """Return what a teacher reads of it: how many are reached, and how far the next one is."""
        best = curriculum.find(curriculum.next)
        if best is None:
            return self.summary(curriculum)
        label, progress = self.label(best), self.progress(best)
        following = self._say("assignments.next in brief", assignment=label, progress=progress)
        return f"{self.summary(curriculum)} · {following}"

    def advice(self, curriculum: CurriculumMessage) -> str:
        """Return what to practice next, and why."""
        best = curriculum.find(curriculum.next)
        if best is None:
            return self._say("assignments.all reached")
        if not best.played:
            return self._say("assignments.next unplayed", assignment=self.title(best))
        sentence = self._say("assignments.next", assignment=self.title(best))
        part = f"assignments.part {best.weakest}"
        if part not in self._texts:
            return sentence
        return f"{sentence} {self._say('assignments.weakest', part=self._say(part))}"
