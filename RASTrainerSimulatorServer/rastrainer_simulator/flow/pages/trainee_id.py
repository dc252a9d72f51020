"""The trainee's ID, entered by buttons or clicks, and the questionnaires of a study."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

from rastrainer.study.protocol.questionnaires import QuestionnaireItem, find_questionnaire
from rastrainer.study_messages import StudyStep
from rastrainer_simulator.flow.pages.session_page import SessionPage, stepped
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.presentation.screen import Fact

ROWS = ("ABCDEFGHIJ", "KLMNOPQRST", "UVWXYZ-_.", "0123456789")
MAX_KNOWN = 5


class _IdPage(SessionPage):
    """Shows the ID as far as it is entered; `write` takes the new one."""

    def __init__(self, session: TrainingSession, write: Callable[[str], None]) -> None:
        super().__init__(session)
        self._write = write

    def _content(self, title: str, *rows: PageRow) -> PageContent:
        entered = Fact(self.say("experiment.trainee"), self.session.trainee + "_")
        return PageContent(self.say(title), (), (entered,), rows)

    def _delete(self) -> PageRow:
        return self.button("delete", lambda: self._write(self.session.trainee[:-1]))

    def _add(self, character: str) -> None:
        self._write(self.session.trainee + character)


class KeyboardPage(_IdPage):
    """Rows of characters: left and right choose one, accepting types it."""

    name = "keyboard"

    def __init__(self, session: TrainingSession, write: Callable[[str], None]) -> None:
        super().__init__(session, write)
        self._chosen = [row[0] for row in ROWS]

    def content(self) -> PageContent:
        rows = (self._row(number) for number in range(len(ROWS)))
        return self._content("keyboard.title", *rows, self._delete(), self.button("done"))

    def _row(self, number: int) -> PageRow:
        """Return a row of characters, with the chosen one in brackets."""
        chosen = self._chosen[number]
        shown = " ".join(f"[{each}]" if each == chosen else each for each in ROWS[number])
        label = self.say("keyboard.row")
        row = self.choice(f"row{number}", shown, partial(self._step, number), label=label)
        return replace(row, accept=lambda: self._add(chosen))

    def _step(self, number: int, direction: int) -> None:
        self._chosen[number] = stepped(ROWS[number], self._chosen[number], direction)


class ClickedIdPage(_IdPage):
    """Offers the IDs that have trained here last, and rows of characters to enter another one."""

    name = "clicked-id"

    def content(self) -> PageContent:
        known = (
            self.button(f"known {trainee}", partial(self._use, trainee), label=trainee)
            for trainee in self.session.progress.latest_trainees(MAX_KNOWN)
        )
        rows = (
            self.button(
                f"row {number}",
                self.open_page(CharacterPage, self._write, row),
                label=" ".join(row),
            )
            for number, row in enumerate(ROWS)
        )
        return self._content("clicked-id.title", *known, *rows, self._delete(), self.button("done"))

    def _use(self, trainee: str) -> None:
        self._write(trainee)
        self.back()


class CharacterPage(_IdPage):
    """The characters of one row: a click adds one to the ID."""

    name = "character"

    def __init__(self, session: TrainingSession, write: Callable[[str], None], row: str) -> None:
        super().__init__(session, write)
        self._row = row

    def content(self) -> PageContent:
        characters = (
            self.button(character, partial(self._take, character), label=character)
            for character in self._row
        )
        return self._content("clicked-id.title", *characters, self.button("back"))

    def _take(self, character: str) -> None:
        self._add(character)
        self.back()


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
        keep = self.button("keep", self._keep, is_enabled=is_complete, help=help_)
        ends = self._ends(asked.name)
        text = self.say("questionnaire.text", trainee=self._step.trainee, **ends)
        return PageContent(asked.title, (text,), rows=(*items, keep, self.button("back")))

    def _item(self, number: int, item: QuestionnaireItem) -> PageRow:
        """Return an item's question, with the ends of its scale if they are its own."""
        line = self.say(item.name)
        if item.anchors:
            line = self.say("questionnaire.ends", topic=line, **self._ends(item.name))
        answer = str(self._answers.get(item.name, UNANSWERED))
        mark = partial(self._mark, item.name)
        return self.choice(item.name, answer, mark, label=f"{number}. {line}")

    def _ends(self, name: str) -> dict[str, object]:
        asked = self._questionnaire
        ends = {"low": self.say(f"{name}.low"), "high": self.say(f"{name}.high")}
        return {"lowest": asked.lowest, "highest": asked.highest, **ends}

    def _mark(self, name: str, direction: int) -> None:
        """Go to the next or previous mark; the first step goes to the end where it came from."""
        marks = self._questionnaire.marks
        first = marks[-1] if direction > 0 else marks[0]
        self._answers[name] = stepped(marks, self._answers.get(name, first), direction)

    def _keep(self) -> None:
        answers = [self._answers[asked.name] for asked in self._questionnaire.items]
        self.session.study.answer(self._step.trainee, answers)
        self.back()

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Close when the study has moved on, for example with answers given in Slicer."""
        if self.session.study.step_of(self._step.trainee) != self._step:
            self.back()
