"""`slicer.app`: the part of Slicer's application that modules use."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from PySide6 import QtCore, QtGui, QtWidgets

from Testing.slicer.host.checked import Checked
from Testing.slicer.host.error_log import ErrorLog
from Testing.slicer.host.io_manager import CoreIOManager
from Testing.slicer.host.members import FACTS
from Testing.slicer.host.other_modules import ModuleManager
from Testing.slicer.host.proxy import wrap
from Testing.slicer.host.python_slicer import write_python_slicer
from Testing.slicer.host.slots import Slot
from Testing.slicer.host.values import from_qt

NAME = "3D Slicer of the tests"


class Application(Checked):
    """Stands in for `qSlicerApplication`; its folders lie in a temporary one."""

    measured = frozenset(FACTS["slicer.app"])
    title = "slicer.app"

    def __init__(self, folder: Path, application_logic: Any, layout_manager: Any) -> None:
        self._settings = _settings_of_last_time(folder)
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
        self._startup_listeners: list[Slot] = []
        self._error_log = ErrorLog(folder / "log")
        self._exit_status: int | None = None
        write_python_slicer(Path(self.slicerHome))

    def connect(self, signal: str, slot: Callable[[], Any]) -> bool:
        if signal != "startupCompleted()":
            raise NotImplementedError(f"The host does not offer {signal} of slicer.app yet.")
        self._startup_listeners.append(Slot(slot, 0))
        return True

    def _complete_startup(self) -> None:
        """Tell, as Slicer does once, that all modules are loaded."""
        for listener in self._startup_listeners:
            listener()

    def errorLogModel(self) -> ErrorLog:
        return self._error_log

    def coreIOManager(self) -> CoreIOManager:
        return CoreIOManager()

    def commandOptions(self) -> Any:
        return SimpleNamespace(runPythonAndExit=True)

    def exit(self, status: int) -> None:
        self._exit_status = status

    def exit_status_of_host(self) -> int | None:
        """Return with which status Slicer was asked to end; None where it was not."""
        return self._exit_status

    def close_of_host(self) -> None:
        """Write no log any more."""
        self._error_log.close()

    def setAttribute(self, attribute: int, on: bool = True) -> None:
        QtCore.QCoreApplication.setAttribute(QtCore.Qt.ApplicationAttribute(attribute), on)

    def activeModalWidget(self) -> Any | None:
        dialog = QtWidgets.QApplication.activeModalWidget()
        return None if dialog is None else wrap(dialog)

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


def _settings_of_last_time(folder: Path) -> QtCore.QSettings:
    """Return the settings that an earlier Slicer has left in the folder.

    Qt would hand out what it still has in memory, with its types; a new file is read as a text.
    """
    earlier = sorted(folder.glob("Slicer-*.ini"))
    path = folder / f"Slicer-{len(earlier):03d}.ini"
    if earlier:
        path.write_bytes(earlier[-1].read_bytes())
    return QtCore.QSettings(str(path), QtCore.QSettings.Format.IniFormat)
