"""A questionnaire that a study asks: a line an item, none answered beforehand."""

from __future__ import annotations

from rastrainer.study.protocol.questionnaires import QuestionnaireItem, find_questionnaire
from rastrainer.study.protocol.study_step import StudyStep
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.net.views.screen import Menu

UNANSWERED = "–"


class QuestionnairePage(SessionPage):
    """Takes an answer to each item, and hands them over together for Slicer to keep."""

    name = "questionnaire"

    def __init__(self, session: TrainingSession, step: StudyStep) -> None:
        """Show the questionnaire of a step.

        Raises:
            InputError: this version knows no such questionnaire.
        """
        super().__init__(session)
        self._step = step
        self._questionnaire = find_questionnaire(step.questionnaire)
        self._answers: dict[str, int] = {}

    def menu(self) -> Menu:
        """Return the items, each with its answer."""
        asked = self._questionnaire
        items = tuple(
            self.choice(
                item.name,
                str(self._answers.get(item.name, UNANSWERED)),
                label=f"{number}. {self._line(item)}",
            )
            for number, item in enumerate(asked.items, start=1)
        )
        is_complete = len(self._answers) == len(asked.items)
        keep = self.button(
            "keep",
            is_enabled=is_complete,
            help="" if is_complete else self.say("questionnaire.open"),
        )
        text = self.say(
            "questionnaire.text",
            trainee=self._step.trainee,
            lowest=asked.lowest,
            highest=asked.highest,
            low=self.say(f"{asked.name}.low"),
            high=self.say(f"{asked.name}.high"),
        )
        return Menu(self.name, asked.title, (text,), items=(*items, keep, self.button("back")))

    def _line(self, item: QuestionnaireItem) -> str:
        """Return what an item is about, with its ends where they are its own."""
        topic = self.say(item.name)
        if not item.anchors:
            return topic
        return self.say(
            "questionnaire.ends",
            topic=topic,
            lowest=self._questionnaire.lowest,
            highest=self._questionnaire.highest,
            low=self.say(f"{item.name}.low"),
            high=self.say(f"{item.name}.high"),
        )

    def step(self, item: str, direction: int) -> None:
        """Go to the next or previous mark; the first step goes to the end where it came from."""
        marks = self._questionnaire.marks
        if item not in self._answers:
            self._answers[item] = marks[0] if direction > 0 else marks[-1]
        else:
            place = marks.index(self._answers[item]) + direction
            self._answers[item] = marks[place % len(marks)]

    def accept(self, item: str) -> None:
        """Hand the answers over, or leave without them."""
        if item == "keep":
            answers = [self._answers[asked.name] for asked in self._questionnaire.items]
            self.session.study.answer(self._step.trainee, answers)
        self.back()

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Close when the study continues otherwise, such as with answers given in Slicer."""
        if self.session.study.step_of(self._step.trainee) != self._step:
            self.back()
