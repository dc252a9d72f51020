"""The trainee's ID, entered by buttons or clicks, and the questionnaires of a study."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

from rastrainer.study.protocol.questionnaires import QuestionnaireItem, find_questionnaire
from rastrainer.study_messages import StudyStep
from rastrainer_simulator.flow.pages.session_page import SessionPage, page_kind, stepped
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.presentation.screen import Fact

ROWS = ("ABCDEFGHIJ", "KLMNOPQRST", "UVWXYZ-_.", "0123456789")
MAX_KNOWN = 5


Write = Callable[[str], None]
"""Takes the new ID."""


def _id_content(page: SessionPage, name: str, rows: Iterable[PageRow]) -> PageContent:
    entered = Fact(page.say("experiment.trainee"), page.session.trainee + "_")
    return PageContent(page.say(f"{name}.title"), (), (entered,), tuple(rows))


def _delete(page: SessionPage, write: Write) -> PageRow:
    return page.button("delete", lambda: write(page.session.trainee[:-1]))


class KeyboardPage(SessionPage):
    """Rows of characters: left and right choose one, accepting types it."""

    name = "keyboard"

    def __init__(self, session: TrainingSession, write: Write) -> None:
        super().__init__(session)
        self._write = write
        self._chosen = [row[0] for row in ROWS]

    def content(self) -> PageContent:
        rows = (self._row(number) for number in range(len(ROWS)))
        others = _delete(self, self._write), self.button("done")
        return _id_content(self, "keyboard", (*rows, *others))

    def _row(self, number: int) -> PageRow:
        chosen = self._chosen[number]

        def step(direction: int) -> None:
            self._chosen[number] = stepped(ROWS[number], chosen, direction)

        shown = " ".join(f"[{each}]" if each == chosen else each for each in ROWS[number])
        row = self.choice(f"row{number}", shown, step, label=self.say("keyboard.row"))
        return replace(row, accept=lambda: self._write(self.session.trainee + chosen))


@page_kind("clicked-id")
def clicked_id_page(page: SessionPage, write: Write) -> PageContent:
    """Offer the IDs that have trained here last, and rows of characters to enter another one."""

    def use(trainee: str) -> None:
        write(trainee)
        page.back()

    known = (
        page.button(f"known {trainee}", partial(use, trainee), label=trainee)
        for trainee in page.session.history.latest_trainees[:MAX_KNOWN]
    )
    rows = (
        page.button(
            f"row {number}", page.open_page(character_page, write, row), label=" ".join(row)
        )
        for number, row in enumerate(ROWS)
    )
    others = _delete(page, write), page.button("done")
    return _id_content(page, "clicked-id", (*known, *rows, *others))


@page_kind("character")
def character_page(page: SessionPage, write: Write, row: str) -> PageContent:
    """Show the characters of one row: a click adds one to the ID."""

    def add(character: str) -> None:
        write(page.session.trainee + character)
        page.back()

    characters = (page.button(each, partial(add, each), label=each) for each in row)
    return _id_content(page, "clicked-id", (*characters, page.button("back")))


UNANSWERED = "–"


class QuestionnairePage(SessionPage):
    """Collects an answer to each item, and submits them together for Slicer to store."""

    name = "questionnaire"

    def __init__(self, session: TrainingSession, step: StudyStep) -> None:
        super().__init__(session)
        self._step = step
        self._questionnaire = find_questionnaire(step.questionnaire)
        self._answers: dict[str, int] = {}

    def content(self) -> PageContent:
        asked = self._questionnaire
        items = (self._item(number, item) for number, item in enumerate(asked.items, start=1))
        is_complete = len(self._answers) == len(asked.items)
        help_ = "" if is_complete else self.say("questionnaire.open")

        def keep() -> None:
            answers = [self._answers[item.name] for item in asked.items]
            self.session.services.assigned.answer(self._step.trainee, answers)
            self.back()

        ends = self._ends(asked.name)
        text = self.say("questionnaire.text", trainee=self._step.trainee, **ends)
        button = self.button("keep", keep, is_enabled=is_complete, help=help_)
        return PageContent(asked.title, (text,), rows=(*items, button, self.button("back")))

    def _item(self, number: int, item: QuestionnaireItem) -> PageRow:
        """Return an item's question, with the ends of its scale if they are its own."""
        line = self.say(item.name)
        if item.anchors:
            line = self.say("questionnaire.ends", topic=line, **self._ends(item.name))
        answer = str(self._answers.get(item.name, UNANSWERED))

        def mark(direction: int) -> None:
            """Go to the next or previous mark; the first step goes to the end it came from."""
            marks = self._questionnaire.marks
            first = marks[-1] if direction > 0 else marks[0]
            before = self._answers.get(item.name, first)
            self._answers[item.name] = stepped(marks, before, direction)

        return self.choice(item.name, answer, mark, label=f"{number}. {line}")

    def _ends(self, name: str) -> dict[str, object]:
        asked = self._questionnaire
        ends = {"low": self.say(f"{name}.low"), "high": self.say(f"{name}.high")}
        return {"lowest": asked.lowest, "highest": asked.highest, **ends}

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Close when the study has moved on, for example with answers given in Slicer."""
        if self.session.services.assigned.steps.get(self._step.trainee) != self._step:
            self.back()
