"""Texts, tables, choices and buttons of the panels, and long work that its button cancels."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, TypeVar

import qt
import slicer

from rastrainer.number_text import fixed
from rastrainer.slicer.link.link_status import LinkState
from rastrainer.slicer.settings import Setting, Settings
from rastrainer.slicer.translation import _
from rastrainer.widgets.plain_text import LONGEST_TEXT, shortened, shortName, toolTip, wrappable
from rastrainer.widgets.section_layout import configureLabel
from rastrainer.widgets.shown_errors import guardedAction
from rastrainer.work_progress import Progress

GREEN, YELLOW, RED, GRAY = "#2e9e44", "#c98a00", "#d03030", "#888888"
LINK_LOOKS = {
    LinkState.OFF: (GRAY, _("Not connected")),
    LinkState.NOT_INSTALLED: (RED, _("Not installed")),
    LinkState.LOOKING: (YELLOW, _("Looking")),
    LinkState.ABSENT: (RED, _("No answer")),
    LinkState.OTHER_PROGRAM: (RED, _("No simulator")),
    LinkState.GREETING: (YELLOW, _("Connecting")),
    LinkState.CONNECTED: (GREEN, _("Connected")),
    LinkState.STALE: (YELLOW, _("Silent")),
    LinkState.WRONG_VERSION: (RED, _("Wrong version")),
}
"""Color and word of each state of the link."""


def setProperty(widget: Any, name: str, value: Any) -> None:
    """Set a property only to another value: Qt may paint the whole window again."""
    if getattr(widget, name) != value:
        setattr(widget, name, value)


def setLight(label: Any, color: str) -> None:
    """Show a colored dot in a label; words next to it say the same."""
    setProperty(label, "text", f'<span style="color:{color}">●</span>')


def setText(label: Any, text: str, tip: str = "") -> None:
    """Show what anyone may have written in a label, which takes no space while it is empty.

    Overlong text is shown in full in the tool tip, in place of `tip`.
    """
    shown, wasEmpty = wrappable(shortened(text, LONGEST_TEXT)), not label.text
    setProperty(label, "text", shown)
    setProperty(label, "toolTip", toolTip(text if len(text) > LONGEST_TEXT else tip))
    # In a closed section, CTK hides a widget again, and the whole window gets a new layout.
    if wasEmpty == bool(shown):
        label.visible = bool(shown)


def showPercent(label: Any, step: str, share: float) -> None:
    if step:
        setText(label, f"{step}: {100 * share:.0f} %")


def textLabel(text: str) -> Any:
    """Return a label for text by anyone, configured like the labels of the `.ui` files."""
    label = qt.QLabel(wrappable(shortened(text, LONGEST_TEXT)))
    configureLabel(label, isWrapped=True)
    return label


def connectAsPressed(button: Any, action: Callable[[], Callable[[], None]]) -> None:
    """Have a click do what the button meant when it was pressed.

    A button may get another meaning while the mouse is down, such as Resume for Pause: `action`
    returns the function of its present label.
    """
    pressed: list[Callable[[], None]] = []

    def notePress() -> None:
        pressed[:] = [action()]

    button.connect("pressed()", notePress)
    button.connect("clicked()", lambda: (pressed.pop() if pressed else action())())


def setEnabled(button: Any, isEnabled: bool, reason: str, tip: str = "") -> None:
    """Enable a button with a tip, or its tool tip in the `.ui` file, or give the reason why not."""
    # In a closed group, each button says that it is disabled.
    button.enabled = isEnabled
    shown = reason if reason and not isEnabled else tip or button.whatsThis
    setProperty(button, "toolTip", toolTip(shown))


def fillTable(table: Any, rows: Iterable[Sequence[str]], tips: Sequence[str] = ()) -> bool:
    """Show rows in a `QTableWidget`, and return whether it showed others.

    Each text, or the row's tip, is its tool tip.
    """
    rows = list(rows)
    hasChanged = table.rowCount != len(rows)
    setProperty(table, "rowCount", len(rows))
    for number, texts in enumerate(rows):
        for column, text in enumerate(texts):
            shown = shortened(text, LONGEST_TEXT), toolTip(tips[number] if tips else text)
            item = table.item(number, column)
            if item is None or (item.text(), item.toolTip()) != shown:
                item, hasChanged = qt.QTableWidgetItem(shown[0]), True
                item.setToolTip(shown[1])
                table.setItem(number, column, item)
    if hasChanged:
        table.resizeColumnsToContents()
        table.resizeRowsToContents()
    return hasChanged


@contextlib.contextmanager
def blockedSignals(widget: Any) -> Iterator[None]:
    wasBlocked = widget.blockSignals(True)
    try:
        yield
    finally:
        widget.blockSignals(wasBlocked)


def setSilently(widget: Any, name: str, value: Any) -> None:
    """Set a property without a signal: the user has not chosen it."""
    with blockedSignals(widget):
        setProperty(widget, name, value)


def fillComboBox(combo: Any, entries: Iterable[tuple[str, str]], chosen: str) -> None:
    """Replace the entries (text, data) of a `QComboBox` and choose one, without a signal."""
    entries = [(shortName(text), data) for text, data in entries]
    with blockedSignals(combo):
        if not isFilled(combo, entries):
            combo.clear()
            for text, data in entries:
                combo.addItem(text, data)
        index = next((i for i, (_text, data) in enumerate(entries) if data == chosen), -1)
        setProperty(combo, "currentIndex", index)


def offerEntries(combo: Any, entries: Sequence[tuple[str, str]], *wanted: str) -> None:
    """Fill a `QComboBox`, and choose the first wanted entry that is in it, or else the first."""
    known = [data for _text, data in entries]
    fillComboBox(combo, entries, next((each for each in (*wanted, *known) if each in known), ""))


def isFilled(combo: Any, entries: Iterable[tuple[str, str]]) -> bool:
    shown = [(combo.itemText(i), combo.itemData(i)) for i in range(combo.count)]
    return shown == [(shortName(text), data) for text, data in entries]


def chosenData(combo: Any) -> str:
    """Return the data of the chosen entry; empty if there is none."""
    return combo.itemData(combo.currentIndex) if combo.currentIndex >= 0 else ""


def numberOrDash(value: float | None, digits: int, unit: str = "") -> str:
    """Return a number, with a space before its unit, or a dash if it is unknown."""
    return "–" if value is None else f"{fixed(value, digits)} {unit}".rstrip()


_CHANGES = {
    "checked": "toggled(bool)",
    "text": "textChanged(QString)",
    "value": "valueChanged(int)",
    "currentPath": "currentPathChanged(QString)",
}


def bind(widget: Any, name: str, settings: Settings, setting: Setting[Any]) -> None:
    """Give a property of a widget the value of a setting, which then follows the user's choice."""
    setattr(widget, name, settings.get(setting))
    widget.connect(_CHANGES[name], lambda value: settings.set(setting, value))


def bindChosen(
    combo: Any, entries: Sequence[tuple[str, str]], settings: Settings, setting: Setting[str]
) -> None:
    offerEntries(combo, entries, settings.get(setting), setting.usual)
    combo.connect("activated(int)", lambda _index: settings.set(setting, chosenData(combo)))


T = TypeVar("T")


class _CanceledError(Exception):
    pass


class CancelableWork:
    """Runs one piece of work at a time; meanwhile its button says Cancel, and does that."""

    def __init__(
        self,
        button: Any,
        start: Callable[[], None],
        failure: str,
        showSentence: Callable[[str], None],
        showUsable: Callable[[], None] = lambda: None,
        show: Progress | None = None,
    ) -> None:
        """Have a click call `start`, which calls `run`, or cancel the work.

        `showSentence` shows a sentence, an empty one where the work has failed; `showUsable` is
        called when it begins and ends. Without `show`, each step is shown as a sentence.
        """
        self.isUnderWay = self._isCanceled = False
        self._button = button
        self._showSentence, self._show, self._showUsable = showSentence, show, showUsable
        guarded = guardedAction(start, failure)
        connectAsPressed(button, lambda: self.cancel if self.isUnderWay else guarded)

    def run(self, work: Callable[[Progress], T]) -> T | None:
        """Return what the work returns, None if the user cancels it."""
        self.isUnderWay, self._isCanceled = True, False
        title, self._button.text = self._button.text, _("Cancel")
        self._showUsable()
        try:
            return work(self._progress)
        except _CanceledError:
            self._showSentence(_("Canceled; nothing has changed."))
            return None
        except BaseException:
            self._showSentence("")
            raise
        finally:
            self.isUnderWay = False
            self._button.text = title
            self._showUsable()

    def cancel(self) -> None:
        """Cancel the running work, when it next reports its progress."""
        self._isCanceled = True

    def _progress(self, step: str, share: float) -> None:
        if self._show is not None:
            self._show(step, share)
        elif step:
            self._showSentence(step)
        slicer.app.processEvents()
        if self._isCanceled:
            raise _CanceledError
