"""A user of Slicer: presses, choices, seen texts and pictures."""

from __future__ import annotations

import faulthandler
import re
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from PySide6 import QtCore, QtGui, QtTest, QtWidgets

from Testing.slicer.host import event_loop, pictures
from Testing.slicer.host.answers import ANSWERS
from Testing.slicer.host.proxy import wrap
from Testing.slicer.host.stand_ins.ctk import ctkCollapsibleButton, ctkCollapsibleGroupBox

DOCK_WIDTH = 470
TIMEOUT_S = 2.0
MIN_ROUNDS = 20
"""How long to wait for a widget to become visible."""


class User:
    """The hands and the eyes of a user of the host, which has the widgets."""

    scene: Any
    widget: Any
    clicks: list[str]
    keeps_lock: bool
    messages: list[Any]
    errors: list[str]
    _frame: Any
    _layout: Any

    # Actions of a user

    def find(self, name: str) -> Any:
        """Return the widget of that name."""
        found = self._frame._qt.findChild(QtCore.QObject, name)
        if found is None:
            raise AssertionError(f"There is no widget {name}.")
        return wrap(found)

    def press(self, name: str) -> None:
        """Press a button, which must be enabled and visible."""
        self._click(self._usable(name))

    def choose(self, name: str, choice: Any) -> None:
        """Choose an entry by its text, or a node, in a combo box, list or table row."""
        widget = self._usable(name)
        if hasattr(widget, "setCurrentNode"):
            widget.setCurrentNode(choice)
        elif isinstance(widget, QtWidgets.QComboBox):
            texts = [widget.itemText(index) for index in range(widget.count())]
            index = next((i for i, text in enumerate(texts) if choice in (text, i)), None)
            index = _containing(texts, choice, name) if index is None else index
            widget.hidePopup()
            widget.setCurrentIndex(index)
            widget.activated.emit(index)
        elif isinstance(widget, QtWidgets.QListWidget):
            texts = [widget.item(row).text() for row in range(widget.count())]
            widget.setCurrentRow(_containing(texts, choice, name))
        elif isinstance(widget, QtWidgets.QTableView):
            widget.selectRow(choice)
        else:
            raise AssertionError(f"Nothing can be chosen in {name}.")
        self.process_events()

    def type(self, name: str, text: str) -> None:
        """Replace the text of an edit, or the path of a path edit, and leave it."""
        widget = self._usable(name)
        if isinstance(widget, QtWidgets.QAbstractSpinBox):
            kind = type(widget.value())
            widget.setValue(kind(text))
        elif hasattr(widget, "setCurrentPath"):
            widget.setCurrentPath(text)
        elif isinstance(widget, QtWidgets.QLineEdit):
            widget.selectAll()
            QtTest.QTest.keyClicks(widget, text) if text else widget.clear()
            widget.editingFinished.emit()
        else:
            widget.setPlainText(text)
        self.process_events()

    def check(self, name: str, checked: bool = True) -> None:
        if self._usable(name).isChecked() != checked:
            self._usable(name).click()
        self.process_events()

    def place(self, *position: float) -> None:
        """Click in a view, RAS mm, while points of a markup are placed by mouse."""
        interaction = self.scene.GetNodeByID("vtkMRMLInteractionNodeSingleton")
        selection = self.scene.GetNodeByID("vtkMRMLSelectionNodeSingleton")
        if interaction.GetCurrentInteractionMode() != interaction.Place:
            raise AssertionError("The mouse places no points now.")
        node = self.scene.GetNodeByID(selection.GetActivePlaceNodeID())
        node.AddControlPoint(*position)
        isLine = node.IsA("vtkMRMLMarkupsLineNode") and node.GetNumberOfControlPoints() < 2
        if not interaction.GetPlaceModePersistence() and not isLine:
            interaction.SetCurrentInteractionMode(interaction.ViewTransform)
        self.process_events()

    def answer(self, part: str, answer: Any) -> None:
        """Answer the next dialog that contains `part`: a button, path, text or function."""
        ANSWERS.prepare(part, answer)

    # Sights of a user

    def text(self, name: str) -> str:
        """Return the text of a widget."""
        return self.find(name).text

    def cells(self, name: str) -> list[list[str]]:
        """Return the texts of a table's cells, row by row."""
        table = self.find(name)
        columns = range(table.columnCount)
        return [[table.item(row, n).text() for n in columns] for row in range(table.rowCount)]

    def wait_until(self, condition: Callable[[], Any], what: str, timeout_s: float = 300.0) -> None:
        """Process events until something is true."""
        deadline = time.monotonic() + timeout_s
        while not condition():
            self.process_events()
            if self.errors:
                raise AssertionError(f"While waiting until {what}: {self.errors[0]}")
            if time.monotonic() > deadline:
                faulthandler.dump_traceback(file=sys.__stderr__)
                raise AssertionError(f"In {timeout_s} s it did not happen: {what}. {self._now()}")
            self._wait()

    def finish_work(self) -> None:
        """Wait until the module has shown the results of its background work."""
        work = self.widget.logic.session.work
        # Requested work begins when the module's timer notices it.
        self.widget.onTimeout()
        self.wait_until(lambda: not work.isBusy, "all work is done")

    def _now(self) -> str:
        """Return possible reasons why nothing happens."""
        found = [message.text for message in self.messages]
        work = None if self.widget is None else vars(self.widget.logic.session.work)
        return (
            f"Messages: {found}. Work: {work}. The scene is being processed as a batch: "
            f"{bool(self.scene.IsBatchProcessing())}. Clicks: {self.clicks}."
        )

    def idle_for(self, seconds: float) -> None:
        """Let some time pass, as a waiting user does."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.process_events()
            self._wait()

    def process_events(self) -> None:
        if self.keeps_lock:
            event_loop.process_events_keeping_lock()
        else:
            QtWidgets.QApplication.processEvents()
        QtWidgets.QApplication.sendPostedEvents(None, QtCore.QEvent.Type.DeferredDelete)

    def _wait(self) -> None:
        if self.keeps_lock:
            event_loop.wait_keeping_lock()
        else:
            time.sleep(0.002)

    def sees(self, model: Any) -> bool:
        """Return whether the whole model is within the 3D view."""
        return self._layout.three_d_view_of_host().sees(model)

    def shown_tables(self) -> list[str]:
        """Return the names of the tables that are visible in the layout's views."""
        return self._layout.shown_tables_of_host()

    def legends(self) -> dict[str, list[tuple[str, float]]]:
        """Return, by view, the title of each color legend that is drawn, and its share of it."""
        views = [self._layout.three_d_view_of_host(), *self._layout.slice_views_of_host()]
        return {view.node.GetName(): view.legends(self.scene) for view in views}

    def screenshot(self, path: Path, name: str | None = None, width: int = 430) -> None:
        """Save a picture of the whole panel, or of one widget in it."""
        self._fit(width)
        widget = self._frame._qt if name is None else self.find(name)._qt
        _save(widget.grab(), path)

    def window_screenshot(self, path: Path, width: int = 430) -> None:
        """Save a picture of Slicer's window: the panel, the 3D view and the slices."""
        _save(self._window_picture(width), path)

    def _window_picture(self, width: int = DOCK_WIDTH) -> QtGui.QPixmap:
        self._fit(width)
        return pictures.window(self._frame._qt, self._layout)

    def look_from(self, azimuth: float, elevation: float, zoom: float = 1.0) -> None:
        """Turn the 3D view, degrees from the front, to all that is visible."""
        self._layout.three_d_view_of_host().look_from(azimuth, elevation, zoom)

    def look_at(self, place: tuple, azimuth: float, elevation: float, distance: float) -> None:
        """Turn the 3D view to a position, RAS mm, from a distance, mm."""
        self._layout.three_d_view_of_host().look_at(place, azimuth, elevation, distance)

    def _fit(self, width: int) -> None:
        """Make the panel as high as its contents; layouts within layouts settle one by one."""
        frame, heights = self._frame._qt, [0, -1]
        while heights[-1] != heights[-2]:
            heights.append(max(frame.layout().totalHeightForWidth(width), 100))
            frame.resize(width, heights[-1])
            self._settle()

    def unfold(self, name: str) -> None:
        """Open the folded sections and groups around a widget, by clicks on their headers."""
        self.process_events()
        folds, inner = [], self.find(name)._qt
        while inner is not None:
            if isinstance(inner, (ctkCollapsibleButton, ctkCollapsibleGroupBox)):
                folds.append(inner)
            inner = inner.parentWidget()
        for fold in reversed(folds):
            if fold.collapsed:
                self._click(fold)
                self._settle()

    def minimum_width(self) -> int:
        """Return the width, pixels, below which Slicer cannot make the dock of the module."""
        self._settle()
        return self._frame._qt.minimumSizeHint().width()

    def width(self) -> int:
        """Return the width of the dock, pixels: it grows with its contents, and never shrinks."""
        self._settle()
        return self._frame._qt.width()

    def cut_off(self, width: int) -> list[str]:
        """Return the names of the visible widgets whose text is cut in a dock of a width."""
        self._fit(width)
        widgets = self._frame._qt.findChildren(QtWidgets.QWidget)
        return [each.objectName() for each in widgets if each.isVisible() and _is_cut(each)]

    def _settle(self) -> None:
        """Let layouts within layouts settle one by one."""
        for _round in range(5):
            self.process_events()

    def _click(self, widget: Any) -> None:
        self.clicks.append(widget.objectName())
        clicks: list[bool] = []
        if isinstance(widget, QtWidgets.QAbstractButton):
            widget.clicked.connect(lambda *_checked: clicks.append(True))
        QtTest.QTest.mouseClick(
            widget, QtCore.Qt.MouseButton.LeftButton, pos=_where_to_press(widget)
        )
        if isinstance(widget, QtWidgets.QAbstractButton) and not clicks:
            raise AssertionError(
                f"The click on {widget.objectName()}, {widget.rect()}, was lost: enabled "
                f"{widget.isEnabled()}, visible {widget.isVisible()}, down {widget.isDown()}."
            )
        self.process_events()

    def _usable(self, name: str) -> Any:
        """Return a widget, and open its section before, as a user would."""
        self.unfold(name)
        deadline = time.monotonic() + TIMEOUT_S
        # One that was just recreated or unfolded is shown by an event. Slicer's panel scrolls:
        # no widget is squeezed to nothing when many sections are open.
        rounds = 0
        while not _has_area(self.find(name)._qt):
            rounds += 1
            # A busy machine gets little done in the time.
            if rounds > MIN_ROUNDS and time.monotonic() > deadline:
                break
            self._fit(DOCK_WIDTH)
            self.unfold(name)
        widget = self.find(name)._qt
        if not widget.isEnabled():
            raise AssertionError(f"{name} is disabled: {widget.toolTip()}")
        if not _has_area(widget):
            raise AssertionError(f"{name} is hidden, or {widget.rect()} shows nothing of it.")
        return widget


def _save(picture: QtGui.QPixmap, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if not picture.save(str(path)):
        raise AssertionError(f"The picture {path} cannot be written.")


def _has_area(widget: QtWidgets.QWidget) -> bool:
    return widget.isVisible() and not widget.rect().isEmpty()


BREAKS = re.compile(r"[\s/\-\u200b]")
"""Where Qt wraps a text."""
LEAST_INPUT = 40
"""Pixels of an input in which its text can be read."""


def _is_cut(widget: QtWidgets.QWidget) -> bool:
    if isinstance(widget, QtWidgets.QLabel) and widget.wordWrap():
        parts = BREAKS.split(widget.text())
        words = [widget.fontMetrics().horizontalAdvance(part) for part in parts]
        isTooHigh = widget.heightForWidth(widget.width()) > widget.height()
        return isTooHigh or max(words, default=0) > widget.width()
    if isinstance(widget, (QtWidgets.QLabel, QtWidgets.QPushButton, QtWidgets.QCheckBox)):
        return widget.sizeHint().width() > widget.width()
    if isinstance(widget, QtWidgets.QHeaderView):
        sections = range(widget.count())
        isAcross = widget.orientation() == QtCore.Qt.Orientation.Horizontal
        return isAcross and any(
            widget.sectionSizeFromContents(each).width() > widget.sectionSize(each)
            for each in sections
        )
    inputs = (QtWidgets.QLineEdit, QtWidgets.QComboBox)
    return isinstance(widget, inputs) and widget.width() < LEAST_INPUT


def _where_to_press(button: QtWidgets.QWidget) -> QtCore.QPoint:
    if isinstance(button, QtWidgets.QGroupBox):
        option = QtWidgets.QStyleOptionGroupBox()
        button.initStyleOption(option)
        kinds = QtWidgets.QStyle
        kind, part = kinds.ComplexControl.CC_GroupBox, kinds.SubControl.SC_GroupBoxCheckBox
        return button.style().subControlRect(kind, option, part, button).center()
    return QtCore.QPoint(min(12, button.width() // 2), min(10, button.height() // 2))


def _containing(texts: list[str], choice: str, name: str) -> int:
    for index, text in enumerate(texts):
        if choice in text:
            return index
    raise AssertionError(f"{name} offers no “{choice}”, only: {', '.join(texts)}.")
