"""CTK's inputs."""

from __future__ import annotations

from PySide6 import QtCore, QtWidgets

from Testing.slicer.host.stand_ins.dialogs import QFileDialog

PATH_FRAME = 60
"""Pixels around the path: its combo box's frame and arrow, and the button to browse."""


class ctkComboBox(QtWidgets.QComboBox):
    """A combo box that shows a text while nothing is chosen."""

    def setDefaultText(self, text: str) -> None:
        self.setPlaceholderText(text)

    defaultText = QtCore.Property(
        str, QtWidgets.QComboBox.placeholderText, QtWidgets.QComboBox.setPlaceholderText
    )


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

    def _path(self) -> str:
        return self._edit.text()

    def setCurrentPath(self, path: str) -> None:
        self._edit.setText(path)

    currentPath = QtCore.Property(str, _path, setCurrentPath)

    def _get_filters(self) -> int:
        return self._filters

    def _set_filters(self, filters: int) -> None:
        self._filters = filters

    filters = QtCore.Property(int, _get_filters, _set_filters)

    def _get_name_filters(self) -> list[str]:
        return self._nameFilters

    def _set_name_filters(self, filters: list[str]) -> None:
        self._nameFilters = filters

    nameFilters = QtCore.Property("QStringList", _get_name_filters, _set_name_filters)


class ctkDirectoryButton(QtWidgets.QWidget):
    """A button that shows a folder, and browses for another."""

    directoryChanged = QtCore.Signal(str)
    directorySelected = QtCore.Signal(str)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._button = QtWidgets.QPushButton()
        self._button.clicked.connect(self.browse)
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._button)

    def browse(self) -> None:
        path = QFileDialog.getExistingDirectory(self, "", self._directory())
        if path:
            self.setDirectory(path)
            self.directorySelected.emit(path)

    def _directory(self) -> str:
        return self._button.text()

    def setDirectory(self, path: str) -> None:
        if path != self._directory():
            self._button.setText(path)
            self.directoryChanged.emit(path)

    directory = QtCore.Property(str, _directory, setDirectory)


class ctkSliderWidget(QtWidgets.QWidget):
    """A slider and a spin box of one value."""

    valueChanged = QtCore.Signal(float)
    valueIsChanging = QtCore.Signal(float)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._spin = QtWidgets.QDoubleSpinBox()
        self._slider = QtWidgets.QSlider(QtCore.Qt.Orientation.Horizontal)
        self._slider.setRange(0, 1000)
        row = QtWidgets.QHBoxLayout(self)
        row.setContentsMargins(0, 0, 0, 0)
        row.addWidget(self._slider)
        row.addWidget(self._spin)
        self._slider.sliderMoved.connect(self._move)
        self._spin.valueChanged.connect(self._follow)

    def _move(self, step: int) -> None:
        spin = self._spin
        spin.setValue(spin.minimum() + step / 1000 * (spin.maximum() - spin.minimum()))

    def _follow(self, value: float) -> None:
        spin = self._spin
        span = (spin.maximum() - spin.minimum()) or 1.0
        self._slider.setValue(round(1000 * (value - spin.minimum()) / span))
        self.valueChanged.emit(value)

    value = QtCore.Property(
        float, lambda self: self._spin.value(), lambda self, value: self._spin.setValue(value)
    )
    minimum = QtCore.Property(
        float, lambda self: self._spin.minimum(), lambda self, value: self._spin.setMinimum(value)
    )
    maximum = QtCore.Property(
        float, lambda self: self._spin.maximum(), lambda self, value: self._spin.setMaximum(value)
    )
    singleStep = QtCore.Property(
        float,
        lambda self: self._spin.singleStep(),
        lambda self, value: self._spin.setSingleStep(value),
    )
    decimals = QtCore.Property(
        int, lambda self: self._spin.decimals(), lambda self, value: self._spin.setDecimals(value)
    )
    suffix = QtCore.Property(
        str, lambda self: self._spin.suffix(), lambda self, value: self._spin.setSuffix(value)
    )

    def setValue(self, value: float) -> None:
        self._spin.setValue(value)
