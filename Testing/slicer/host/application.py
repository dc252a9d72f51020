"""`slicer.app`: the part of Slicer's application that modules use."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

from PySide6 import QtCore, QtGui, QtWidgets

from Testing.slicer.host.checked import Checked
from Testing.slicer.host.members import FACTS
from Testing.slicer.host.other_modules import ModuleManager
from Testing.slicer.host.proxy import wrap
from Testing.slicer.host.values import from_qt

NAME = "3D Slicer of the tests"


class Application(Checked):
    """Stands in for `qSlicerApplication`; its folders lie in a temporary one."""

    measured = frozenset(FACTS["slicer.app"])
    title = "slicer.app"

    def __init__(self, folder: Path, application_logic: Any, layout_manager: Any) -> None:
        self._settings = QtCore.QSettings(
            str(folder / "Slicer.ini"), QtCore.QSettings.Format.IniFormat
        )
        self._application_logic = application_logic
        self._layout_manager = layout_manager
        self._module_manager = ModuleManager(application_logic)
        self.applicationName = NAME
        self.slicerHome = str(folder / "Slicer")
        self.temporaryPath = str(folder / "temporary")
        self.extensionsInstallPath = str(folder / "extensions")
        self.majorVersion, self.minorVersion, self.revision = 5, 13, "34000"
        self.applicationVersion = "5.13.0-2026-01-01"
        self.os = {"linux": "linux", "darwin": "macosx", "win32": "win"}[sys.platform]
        Path(self.temporaryPath).mkdir(parents=True, exist_ok=True)
        _write_python_slicer(Path(self.slicerHome))

    def settings(self) -> Any:
        return wrap(self._settings)

    userSettings = settings

    def applicationLogic(self) -> Any:
        return self._application_logic

    def layoutManager(self) -> Any:
        return self._layout_manager

    def moduleManager(self) -> Any:
        return self._module_manager

    def mrmlScene(self) -> Any:
        return self._application_logic.GetMRMLScene()

    def testingEnabled(self) -> bool:
        return False

    def processEvents(self, *_flags: int) -> None:
        QtWidgets.QApplication.processEvents()

    def setOverrideCursor(self, cursor: Any) -> None:
        shape = cursor if isinstance(cursor, int) else cursor._qt.shape()
        QtWidgets.QApplication.setOverrideCursor(QtGui.QCursor(QtCore.Qt.CursorShape(shape)))

    def restoreOverrideCursor(self) -> None:
        QtWidgets.QApplication.restoreOverrideCursor()

    def overrideCursor(self) -> Any:
        return from_qt(QtWidgets.QApplication.overrideCursor())

    def style(self) -> Any:
        return wrap(QtWidgets.QApplication.style())

    def clipboard(self) -> Any:
        return wrap(QtWidgets.QApplication.clipboard())

    def palette(self, *_class: str) -> Any:
        return wrap(QtWidgets.QApplication.palette())

    def topLevelWidgets(self) -> tuple:
        return tuple(wrap(widget) for widget in QtWidgets.QApplication.topLevelWidgets())

    def pauseRender(self) -> None:
        """Nothing is rendered by itself here."""

    def resumeRender(self) -> None:
        """Nothing is rendered by itself here."""

    def isInstalled(self) -> bool:
        return True


def _write_python_slicer(home: Path) -> None:
    """Put Slicer's Python where Slicer has it: here it is that of the tests."""
    program = home / "bin" / "PythonSlicer"
    if os.name == "nt" or program.exists():
        return
    program.parent.mkdir(parents=True, exist_ok=True)
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" "$@"\n')
    program.chmod(0o755)
