"""The trainee's ID, entered by buttons or clicks, and the questionnaires of a study."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import replace
from functools import partial

from rastrainer.study.protocol.questionnaires import QuestionnaireItem, find_questionnaire
from rastrainer.study_messages import StudyStep
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow, page_kind
from rastrainer_simulator.flow.session.session import SessionPage
from rastrainer_simulator.presentation.screen import Fact

ROWS = ("ABCDEFGHIJ", "KLMNOPQRST", "UVWXYZ-_.", "0123456789")
MAX_KNOWN = 5
UNANSWERED = "–"

Write = Callable[[str], None]
"""Takes the new ID."""


def _id_content(page: SessionPage, rows: Iterable[PageRow]) -> PageContent:
    entered = Fact(page.say("experiment.trainee"), page.session.trainee + "_")
    return PageContent((), (entered,), tuple(rows), title=page.say("clicked-id.title"))


def _delete(page: SessionPage, write: Write) -> PageRow:
    return page.button("delete", lambda: write(page.session.trainee[:-1]))


@page_kind("keyboard")
def keyboard_page(page: SessionPage, write: Write, **chosen: str) -> PageContent:
    """Show rows of characters: left and right choose one, accepting types it."""

    def row(number: int, characters: str) -> PageRow:
        name = f"row{number}"
        here = chosen.get(name, characters[0])
        shown = " ".join(f"[{each}]" if each == here else each for each in characters)
        choice = page.choice(name, characters, here, shown, label=page.say("keyboard.row"))
        return replace(choice, accept=lambda: write(page.session.trainee + here))

    others = _delete(page, write), page.button("done")
    return _id_content(page, (*map(row, range(len(ROWS)), ROWS), *others))


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
    return _id_content(page, (*known, *rows, _delete(page, write), page.button("done")))


@page_kind("character")
def character_page(page: SessionPage, write: Write, row: str) -> PageContent:
    def add(character: str) -> None:
        write(page.session.trainee + character)
        page.back()

    characters = (page.button(each, partial(add, each), label=each) for each in row)
    return _id_content(page, (*characters, page.button("back")))


def _has_moved_on(page: SessionPage, step: StudyStep, **_answers: int) -> bool:
    """Return whether the study has another step, for example after answers given in Slicer."""
    return page.session.services.assigned.steps.get(step.trainee) != step


@page_kind("questionnaire", is_over=_has_moved_on)
def questionnaire_page(page: SessionPage, step: StudyStep, **answers: int) -> PageContent:
    """Collect an answer to each item, and submit them together for Slicer to store."""
    asked = find_questionnaire(step.questionnaire)

    def ends(name: str) -> dict[str, object]:
        words = {"low": page.say(f"{name}.low"), "high": page.say(f"{name}.high")}
        return {"lowest": asked.lowest, "highest": asked.highest, **words}

    def row(number: int, item: QuestionnaireItem) -> PageRow:
        line = page.say(item.name)
        if item.anchors:
            line = page.say("questionnaire.ends", topic=line, **ends(item.name))
        mark = answers.get(item.name)
        shown = UNANSWERED if mark is None else str(mark)
        return page.choice(item.name, asked.marks, mark, shown, label=f"{number}. {line}")

    def keep() -> None:
        given = [answers[item.name] for item in asked.items]
        page.session.services.assigned.answer(step.trainee, given)
        page.back()

    is_complete = len(answers) == len(asked.items)
    help_ = "" if is_complete else page.say("questionnaire.open")
    text = page.say("questionnaire.text", trainee=step.trainee, **ends(asked.name))
    button = page.button("keep", keep, is_enabled=is_complete, help=help_)
    items = map(row, range(1, len(asked.items) + 1), asked.items)
    return PageContent((text,), rows=(*items, button, page.button("back")), title=asked.title)
