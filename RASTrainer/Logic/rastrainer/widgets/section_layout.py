"""The look that all tables, labels and sections share, so that no content widens the panel.

A section of CTK is at least as wide as its contents would like to be, and Slicer's window grows
with it, but never shrinks. So a section may be as narrow as its contents allow, a table is as wide
as its section, and a label wraps.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import qt

HIGHEST_TABLE = 270
"""Pixels; a longer table scrolls."""
NARROWEST_BOX = 120
"""Pixels; a box of nodes would be as wide as the longest name of a node."""


def configureWidgets(widgets: Iterable[Any]) -> None:
    """Give the look to all widgets of the `.ui` files, by their class and name."""
    for widget in widgets:
        kind, name = widget.className(), widget.objectName
        if kind == "QTableWidget":
            configureTable(widget)
        elif kind == "ctkCollapsibleButton":
            # Narrow when it is open, and its header alone when not.
            widget.setSizePolicy(qt.QSizePolicy.Preferred, qt.QSizePolicy.Preferred)
            widget.collapsedHeight = 0
        elif kind == "QComboBox":
            # Not as wide as its longest entry.
            widget.sizeAdjustPolicy = qt.QComboBox.AdjustToMinimumContentsLengthWithIcon
        elif kind == "qMRMLNodeComboBox":
            widget.minimumWidth = NARROWEST_BOX
            widget.showChildNodeTypes = widget.addEnabled = widget.removeEnabled = False
            widget.noneEnabled = True
        elif kind == "QPushButton":
            # Its tool tip also says why it is disabled.
            widget.whatsThis = widget.toolTip
        elif kind == "QLabel" and name.endswith("Light"):
            widget.textFormat = qt.Qt.RichText
        elif kind == "QLabel":
            configureLabel(widget, isWrapped=name.endswith("Text"))


def configureLabel(label: Any, isWrapped: bool) -> None:
    """Let a label show what anyone may have written, as it is; `setText` shows it once it has any.

    A wrapped label is more than a caption.
    """
    label.textFormat = qt.Qt.PlainText
    if isWrapped:
        label.wordWrap = True
        label.setSizePolicy(qt.QSizePolicy.Expanding, qt.QSizePolicy.Preferred)
        # A label is at least as wide as its longest word, unless it has another minimum.
        label.minimumWidth = 1
        if not label.text:
            label.visible = False


def configureTable(table: Any) -> None:
    """Let a `QTableWidget` be as wide as its section, and as high as its rows."""
    table.setSizePolicy(qt.QSizePolicy.Ignored, qt.QSizePolicy.Fixed)
    table.sizeAdjustPolicy = qt.QTableWidget.AdjustToContents
    table.maximumHeight = HIGHEST_TABLE
    table.alternatingRowColors = True
    table.editTriggers = qt.QTableWidget.NoEditTriggers
    table.selectionBehavior = qt.QTableWidget.SelectRows
    table.selectionMode = qt.QTableWidget.SingleSelection
    table.verticalHeader().setVisible(False)
    header = table.horizontalHeader()
    # Its texts wrap in what the others leave; its title stays whole.
    header.stretchLastSection = True
    header.minimumSectionSize = header.sectionSizeHint(table.columnCount - 1)
    table.resizeColumnsToContents()
