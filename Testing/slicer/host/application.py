"""`slicer.app`: the part of Slicer's application that modules use."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import slicer
from PySide6 import QtCore, QtGui, QtWidgets

from Testing.slicer.host.failures import ErrorLog
from Testing.slicer.host.members import FACTS, Checked
from Testing.slicer.host.proxy import wrap
from Testing.slicer.host.python_slicer import write_python_slicer
from Testing.slicer.host.sample_data import SampleDataLogic
from Testing.slicer.host.values import Slot, from_qt

NAME = "3D Slicer of the tests"


class Application(Checked):
    """Stands in for `qSlicerApplication`; its folders are temporary."""

    measured = frozenset(FACTS["slicer.app"])
    title = "slicer.app"

    def __init__(self, folder: Path, application_logic: Any, layout_manager: Any) -> None:
        self._settings = _settings_of_last_time(folder)
        self._error_log, modules = ErrorLog(folder / "log"), ModuleManager(application_logic)
        self.applicationName = NAME
        self.slicerHome = str(folder / "Slicer")
        self.temporaryPath = str(folder / "temporary")
        self.extensionsInstallPath = str(folder / "extensions")
        self.majorVersion, self.minorVersion, self.revision = 5, 13, "34000"
        self.applicationVersion = "5.13.0-2026-01-01"
        self.os = {"linux": "linux", "darwin": "macosx", "win32": "win"}[sys.platform]
        self.applicationLogic = lambda: application_logic
        self.commandOptions = lambda: SimpleNamespace(runPythonAndExit=True)
        self.coreIOManager = CoreIOManager
        self.errorLogModel = lambda: self._error_log
        self.isInstalled = lambda: True
        self.layoutManager = lambda: layout_manager
        self.moduleManager = lambda: modules
        self.mrmlScene = application_logic.GetMRMLScene
        self.testingEnabled = lambda: False
        Path(self.temporaryPath).mkdir(parents=True, exist_ok=True)
        self._startup_listeners: list[Slot] = []
        self._exit_status: int | None = None
        write_python_slicer(Path(self.slicerHome))

    def connect(self, signal: str, slot: Callable[[], Any]) -> bool:
        if signal != "startupCompleted()":
            raise NotImplementedError(f"The host does not offer {signal} of slicer.app yet.")
        self._startup_listeners.append(Slot(slot, 0))
        return True

    def _complete_startup(self) -> None:
        """Signal, as Slicer does once, that all modules are loaded."""
        for listener in self._startup_listeners:
            listener()

    def exit(self, status: int) -> None:
        self._exit_status = status

    def exit_status_of_host(self) -> int | None:
        """Return the status with which Slicer was asked to exit; None if it was not."""
        return self._exit_status

    def close_of_host(self) -> None:
        self._error_log.close()

    def setAttribute(self, attribute: int, on: bool = True) -> None:
        QtCore.QCoreApplication.setAttribute(QtCore.Qt.ApplicationAttribute(attribute), on)

    def activeModalWidget(self) -> Any | None:
        dialog = QtWidgets.QApplication.activeModalWidget()
        return None if dialog is None else wrap(dialog)

    def settings(self) -> Any:
        return wrap(self._settings)

    userSettings = settings

    def processEvents(self, *_flags: int) -> None:
        QtWidgets.QApplication.processEvents()

    def setOverrideCursor(self, cursor: Any) -> None:
        shape = cursor if isinstance(cursor, int) else cursor._qt.shape()
        QtWidgets.QApplication.setOverrideCursor(QtGui.QCursor(QtCore.Qt.CursorShape(shape)))

    def restoreOverrideCursor(self) -> None:
        QtWidgets.QApplication.restoreOverrideCursor()

    def overrideCursor(self) -> Any:
        return from_qt(QtWidgets.QApplication.overrideCursor())

    def topLevelWidgets(self) -> tuple:
        return tuple(wrap(widget) for widget in QtWidgets.QApplication.topLevelWidgets())


def _settings_of_last_time(folder: Path) -> QtCore.QSettings:
    """Return the settings that an earlier Slicer has left in the folder.

    Qt would return the values in its memory, with their types; a new file is read as text.
    """
    earlier = sorted(folder.glob("Slicer-*.ini"))
    path = folder / f"Slicer-{len(earlier):03d}.ini"
    if earlier:
        path.write_bytes(earlier[-1].read_bytes())
    return QtCore.QSettings(str(path), QtCore.QSettings.Format.IniFormat)


class CoreIOManager(Checked):
    """Stands in for `qSlicerCoreIOManager`, of which scenes alone are offered."""

    measured = frozenset({"saveNodes", "loadNodes", "fileType", "fileWriterExtensions"})
    title = "slicer.app.coreIOManager()"

    def saveNodes(self, kind: str, properties: dict, _messages: Any = None) -> bool:
        self._check(kind, properties)
        return slicer.mrmlScene.WriteToMRB(properties["fileName"])

    def loadNodes(self, kind: str, properties: dict, _nodes: Any = None, _said: Any = None) -> bool:
        self._check(kind, properties)
        cache, data_io = slicer.vtkCacheManager(), slicer.vtkDataIOManager()
        cache.SetRemoteCacheDirectory(slicer.app.temporaryPath)
        data_io.SetCacheManager(cache)
        slicer.mrmlScene.SetDataIOManager(data_io)
        try:
            clears = properties.get("clear", False)
            return slicer.mrmlScene.ReadFromMRB(properties["fileName"], clears)
        finally:
            slicer.mrmlScene.SetDataIOManager(None)

    def _check(self, kind: str, properties: dict) -> None:
        if kind != "SceneFile" or not str(properties["fileName"]).endswith(".mrb"):
            raise NotImplementedError("Slicer has it, but the host reads and writes .mrb alone.")


class qSlicerScriptedLoadableModule:
    """`slicer.util` asks for this class; the modules here are of another one."""


class Module:
    """A module with its logic."""

    def __init__(self, name: str, logic: Any) -> None:
        self.name = name
        self._logic = logic

    def logic(self) -> Any:
        return self._logic


class ModuleManager:
    """Finds modules by name; a missing one is None."""

    def __init__(self, application_logic: Any) -> None:
        self._application_logic = application_logic
        self._modules: dict[str, Any] = {"SampleData": Module("SampleData", SampleDataLogic())}

    def add(self, module: Any) -> None:
        """Add a scripted module under its name."""
        self._modules[module.name] = module

    def module(self, name: str) -> Any | None:
        logic = self._application_logic.GetModuleLogic(name)
        return Module(name, logic) if logic is not None else self._modules.get(name)
