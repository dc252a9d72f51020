"""CTK's input of a path."""

from __future__ import annotations

from PySide6 import QtCore, QtWidgets

from Testing.slicer.host.stand_ins.dialogs import QFileDialog

PATH_FRAME = 60
"""Pixels around the path: its combo box's frame and arrow, and the button to browse."""


class ctkPathLineEdit(QtWidgets.QWidget):
    """A line for a path, and a button to browse for one.

    It is as wide as its path unless it is configured, like CTK's: a long path widens the dock.
    """

    Dirs, Files, Drives, NoSymLinks, Readable, Writable, Executable = (1 << n for n in range(7))

    currentPathChanged = QtCore.Signal(str)
    validInputChanged = QtCore.Signal(bool)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._edit = QtWidgets.QLineEdit()
        self._filters = self.Dirs | self.Files | self.Drives
        self._nameFilters: list[str] = []
        button = QtWidgets.QToolButton()
        button.setText("…")
        button.clicked.connect(self.browse)
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._edit)
        row.addWidget(button)
        self._edit.textChanged.connect(self.currentPathChanged)

    def minimumSizeHint(self) -> QtCore.QSize:
        hint = super().minimumSizeHint()
        text = self._edit.text()
        width = self._edit.fontMetrics().horizontalAdvance(text or 7 * "x")
        return hint.expandedTo(QtCore.QSize(width + PATH_FRAME, 0))

    def browse(self) -> None:
        isFolder = not self._filters & self.Files
        choose = QFileDialog.getExistingDirectory if isFolder else QFileDialog.getOpenFileName
        path = choose(self, self.objectName(), self._edit.text())
        if path:
            self._edit.setText(path)

    def setCurrentPath(self, path: str) -> None:
        self._edit.setText(path)

    currentPath = QtCore.Property(str, lambda self: self._edit.text(), setCurrentPath)

    def _set_filters(self, filters: int) -> None:
        self._filters = filters

    filters = QtCore.Property(int, lambda self: self._filters, _set_filters)

    def _set_name_filters(self, filters: list[str]) -> None:
        self._nameFilters = filters

    nameFilters = QtCore.Property("QStringList", lambda self: self._nameFilters, _set_name_filters)
