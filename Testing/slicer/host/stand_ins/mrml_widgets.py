"""Slicer's widgets that show a part of the scene."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from PySide6 import QtCore, QtGui, QtWidgets


class qMRMLWidget(QtWidgets.QWidget):
    """Hands the scene to all its children, as the connections of a `.ui` file do."""

    mrmlSceneChanged = QtCore.Signal(object)

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._scene: Any = None

    def mrmlScene(self) -> Any:
        return self._scene

    def setMRMLScene(self, scene: Any) -> None:
        self._scene = scene
        self.mrmlSceneChanged.emit(scene)


class qSlicerScriptedLoadableModuleWidget(qMRMLWidget):
    """The frame of a module's widgets."""

    def __init__(self, parent: QtWidgets.QWidget | None = None) -> None:
        super().__init__(parent)
        self._isEntered = False
        QtWidgets.QVBoxLayout(self)

    def enter(self) -> None:
        self._isEntered = True

    def exit(self) -> None:
        self._isEntered = False

    isEntered = QtCore.Property(bool, lambda self: self._isEntered)


class qSlicerMainWindow(QtWidgets.QMainWindow):
    """The window of the application; `slicer.util.mainWindow` finds it by its name."""

    def __init__(self) -> None:
        super().__init__()
        self.setObjectName("qSlicerMainWindow")
        self._selector: Any = None
        self._picture: Callable[[], QtGui.QPixmap] | None = None

    def setPicture(self, picture: Callable[[], QtGui.QPixmap]) -> None:
        """Let the host draw what the window shows."""
        self._picture = picture

    def grab(self, *_rectangle: object) -> QtGui.QPixmap:
        """Return a picture of the window."""
        return self._picture()

    def setModuleSelector(self, selector: Any) -> None:
        """Let the host say what its list of modules does."""
        self._selector = selector

    def moduleSelector(self) -> Any:
        return self._selector
