"""A questionnaire as a form: a line an item, none answered beforehand."""

from __future__ import annotations

from typing import Any

import qt

from rastrainer.errors import InputError
from rastrainer.panels.widgets import chosenData, textLabel
from rastrainer.slicer.translation import _
from rastrainer.study.protocol.questionnaires import Questionnaire, QuestionnaireItem


class QuestionnaireForm:
    """Fills a widget with the items of one questionnaire after another."""

    def __init__(self, widget: Any) -> None:
        """`widget` has a form layout, which is the form's alone."""
        self._widget = widget
        self._key: Any = None
        self._questionnaire: Questionnaire | None = None
        self._boxes: list[Any] = []
        self._parts: list[Any] = []

    def show(self, key: Any, questionnaire: Questionnaire | None) -> None:
        """Show a questionnaire, empty, unless it is the one of this key that is shown already."""
        if key == self._key:
            return
        self._key, self._questionnaire = key, questionnaire
        self._clear()
        if questionnaire is None:
            return
        head = textLabel(
            _(
                "{title}: {lowest} is {low}, {highest} is {high}, unless a line says otherwise. "
                "Read the wording from its form."
            ).format(
                title=questionnaire.title,
                lowest=questionnaire.lowest,
                low=questionnaire.anchors[0],
                highest=questionnaire.highest,
                high=questionnaire.anchors[1],
            )
        )
        layout = self._widget.layout()
        layout.addRow(head)
        self._parts.append(head)
        for number, item in enumerate(questionnaire.items, start=1):
            label, box = textLabel(f"{number}. {_lineOf(item, questionnaire)}"), qt.QComboBox()
            label.setObjectName(f"{item.name}Label")
            box.setObjectName(f"{item.name}ComboBox")
            box.addItem("–", "")
            for mark in questionnaire.marks:
                box.addItem(str(mark), str(mark))
            layout.addRow(label, box)
            self._parts += [label, box]
            self._boxes.append(box)

    def answers(self) -> tuple[int, ...]:
        """Return the answers in the order of the items.

        Raises:
            InputError: an item is not answered.
        """
        chosen = [chosenData(box) for box in self._boxes]
        open_ = [str(number) for number, mark in enumerate(chosen, start=1) if not mark]
        if open_ and self._questionnaire is not None:
            raise InputError(
                _("{title}: not answered yet: {items}.").format(
                    title=self._questionnaire.title, items=", ".join(open_)
                )
            )
        return tuple(int(mark) for mark in chosen)

    def _clear(self) -> None:
        for part in self._parts:
            self._widget.layout().removeWidget(part)
            part.setParent(None)
            part.deleteLater()
        self._parts, self._boxes = [], []


def _lineOf(item: QuestionnaireItem, questionnaire: Questionnaire) -> str:
    """Return what an item is about, with its ends where they are its own."""
    if not item.anchors:
        return item.topic
    return _("{topic}: {lowest} is {low}, {highest} is {high}").format(
        topic=item.topic,
        lowest=questionnaire.lowest,
        low=item.anchors[0],
        highest=questionnaire.highest,
        high=item.anchors[1],
    )
