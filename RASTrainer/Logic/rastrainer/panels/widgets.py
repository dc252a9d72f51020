"""What several panels do with their widgets."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import qt

HIGHEST_TABLE = 270
FRAME, SCROLL_BAR = 6, 16
"""Pixels: of a table that need not scroll, of what is around its rows, of a bar below them."""

GREEN, YELLOW, RED, GRAY = "#2e9e44", "#c98a00", "#d03030", "#888888"


def light(color: str) -> str:
    """Return a colored dot as rich text; words beside it say the same."""
    return f'<span style="color:{color}">●</span>'


def setUsable(button: Any, usable: bool, tip: str, reason: str = "") -> None:
    """Enable a button with its tool tip, or disable it with the reason in its place."""
    button.enabled = usable
    button.toolTip = tip if usable or not reason else reason


def fillTable(table: Any, rows: Iterable[Sequence[str]], tips: Sequence[str] = ()) -> None:
    """Replace the rows of a `QTableWidget`; each text, or the row's tip, is its tool tip."""
    rows = list(rows)
    table.setRowCount(len(rows))
    for number, texts in enumerate(rows):
        for column, text in enumerate(texts):
            item = qt.QTableWidgetItem(text)
            item.setToolTip(tips[number] if tips else text)
            table.setItem(number, column, item)
    table.resizeColumnsToContents()
    table.resizeRowsToContents()
    _fitHeight(table)


def setSentence(label: Any, sentence: str) -> None:
    """Show a sentence in a label, which takes no room while there is none."""
    label.text = sentence
    label.visible = bool(sentence)


def fillComboBox(combo: Any, entries: Iterable[tuple[str, str]], chosen: str) -> None:
    """Replace the entries (text, data) of a `QComboBox` and choose one, telling nobody."""
    entries = list(entries)
    shown = [(combo.itemText(i), combo.itemData(i)) for i in range(combo.count)]
    wasBlocked = combo.blockSignals(True)
    if shown != entries:
        combo.clear()
        for text, data in entries:
            combo.addItem(text, data)
    index = next((i for i, (_text, data) in enumerate(entries) if data == chosen), -1)
    if combo.currentIndex != index:
        combo.setCurrentIndex(index)
    combo.blockSignals(wasBlocked)


def chosenData(combo: Any) -> str:
    """Return the data of the chosen entry, empty where there is none."""
    return combo.itemData(combo.currentIndex) if combo.currentIndex >= 0 else ""


def setChecked(box: Any, checked: bool) -> None:
    """Check a box or not, telling nobody."""
    wasBlocked = box.blockSignals(True)
    box.checked = checked
    box.blockSignals(wasBlocked)


def _fitHeight(table: Any) -> None:
    """Make a table as high as its rows, up to a limit from which on it scrolls."""
    rows = sum(table.rowHeight(row) for row in range(table.rowCount))
    columns = sum(table.columnWidth(column) for column in range(table.columnCount))
    bar = SCROLL_BAR if columns > table.viewport().width else 0
    header = table.horizontalHeader().height
    table.setFixedHeight(min(HIGHEST_TABLE, header + rows + bar + FRAME))


def millimeters(value: float | None, digits: int = 2) -> str:
    """Return a length with its unit, a dash where it is not known."""
    return "–" if value is None else f"{value:.{digits}f} mm"
