"""Who trains: an ID entered by buttons or clicks, and the questionnaires that a study asks."""

from __future__ import annotations

from collections.abc import Callable

from rastrainer.study.protocol.questionnaires import QuestionnaireItem, find_questionnaire
from rastrainer.study_messages import StudyStep
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.presentation.screen import Fact, Menu

ROWS = ("ABCDEFGHIJ", "KLMNOPQRST", "UVWXYZ-_.", "0123456789")
MAX_KNOWN = 5
_KNOWN, _ROW = "known ", "row "
"""Prefix of an ID or a row's number in the name of an item."""


class KeyboardPage(SessionPage):
    """Rows of characters: left and right choose one, accepting types it."""

    name = "keyboard"
    steps_when_accepted = False

    def __init__(self, session: TrainingSession, write: Callable[[str, str], None]) -> None:
        super().__init__(session)
        self._write = write
        self._places = [0] * len(ROWS)

    def menu(self) -> Menu:
        """Return the rows, the chosen character of each in brackets."""
        rows = tuple(
            self.choice(f"row{number}", self._row(number), label=self.say("keyboard.row"))
            for number in range(len(ROWS))
        )
        return Menu(
            self.name,
            self.say("keyboard.title"),
            facts=(Fact(self.say("experiment.trainee"), self.session.trainee + "_"),),
            items=(*rows, self.button("delete"), self.button("done")),
        )

    def accept(self, item: str) -> None:
        """Type a character, delete one, or finish."""
        trainee = self.session.trainee
        if item == "done":
            self.back()
        elif item == "delete":
            self._write("trainee", trainee[:-1])
        else:
            number = int(item.removeprefix("row"))
            self._write("trainee", trainee + ROWS[number][self._places[number]])

    def step(self, item: str, direction: int) -> None:
        """Choose the next character of a row."""
        number = int(item.removeprefix("row"))
        self._places[number] = (self._places[number] + direction) % len(ROWS[number])

    def _row(self, number: int) -> str:
        place = self._places[number]
        return " ".join(
            f"[{character}]" if index == place else character
            for index, character in enumerate(ROWS[number])
        )


class ClickedIdPage(SessionPage):
    """Offers the IDs that have trained here last, and rows of characters to enter another one."""

    name = "clicked-id"

    def __init__(self, session: TrainingSession, write: Callable[[str, str], None]) -> None:
        super().__init__(session)
        self._write = write

    def menu(self) -> Menu:
        """Return the ID so far, the known ones and the rows."""
        known = (
            self.button(_KNOWN + trainee, label=trainee)
            for trainee in self.session.progress.latest_trainees(MAX_KNOWN)
        )
        rows = (
            self.button(f"{_ROW}{number}", label=" ".join(ROWS[number]))
            for number in range(len(ROWS))
        )
        return Menu(
            self.name,
            self.say("clicked-id.title"),
            facts=(Fact(self.say("experiment.trainee"), self.session.trainee + "_"),),
            items=(*known, *rows, self.button("delete"), self.button("done")),
        )

    def accept(self, item: str) -> None:
        """Use an ID, open a row, delete a character, or finish."""
        if item.startswith(_ROW):
            row = ROWS[int(item.removeprefix(_ROW))]
            self.session.pages.open(CharacterPage(self.session, self._write, row))
        elif item == "delete":
            self._write("trainee", self.session.trainee[:-1])
        else:
            if item.startswith(_KNOWN):
                self._write("trainee", item.removeprefix(_KNOWN))
            self.back()


class CharacterPage(SessionPage):
    """The characters of one row: a click adds one to the ID."""

    name = "character"

    def __init__(
        self, session: TrainingSession, write: Callable[[str, str], None], row: str
    ) -> None:
        super().__init__(session)
        self._write = write
        self._row = row

    def menu(self) -> Menu:
        """Return the characters."""
        characters = (self.button(character, label=character) for character in self._row)
        return Menu(
            self.name,
            self.say("clicked-id.title"),
            facts=(Fact(self.say("experiment.trainee"), self.session.trainee + "_"),),
            items=(*characters, self.button("back")),
        )

    def accept(self, item: str) -> None:
        if item != "back":
            self._write("trainee", self.session.trainee + item)
        self.back()


UNANSWERED = "–"


class QuestionnairePage(SessionPage):
    """Collects an answer to each item, and submits them together for Slicer to store."""

    name = "questionnaire"

    def __init__(self, session: TrainingSession, step: StudyStep) -> None:
        """Show the questionnaire of a step."""
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
        """Return an item's question, with the ends of its scale if they are its own."""
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
        """Submit the answers, or leave without them."""
        if item == "keep":
            answers = [self._answers[asked.name] for asked in self._questionnaire.items]
            self.session.study.answer(self._step.trainee, answers)
        self.back()

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Close when the study has moved on, for example with answers given in Slicer."""
        if self.session.study.step_of(self._step.trainee) != self._step:
            self.back()
