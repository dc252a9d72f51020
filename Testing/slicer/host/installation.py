"""Puts the host's modules where a module of Slicer's looks for them, and removes them again."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import slicer
from PySide6.QtCore import QStandardPaths

from Testing.slicer.host import parameter_node, sample_data, scripted_module
from Testing.slicer.host.application import qSlicerScriptedLoadableModule
from Testing.slicer.host.members import OFFERED
from Testing.slicer.host.proxy import class_named, ctk, qt

_MISSING = object()


class Installation:
    """Modules and attributes as they were before, until `remove`."""

    def __init__(self) -> None:
        self._modules: dict[str, Any] = {}
        self._attributes: dict[str, Any] = {}

    def add_modules(self) -> None:
        """Make `qt`, `ctk` and the parts of `slicer` that slicer-core lacks importable."""
        translation = ModuleType("slicer.i18n")
        translation.tr = lambda text: text
        translation.translate = lambda _context, text: text
        translation.getContext = lambda file: Path(file).stem
        modules = {
            "qt": qt,
            "ctk": ctk,
            "SampleData": sample_data.make_module(),
            "slicer.i18n": translation,
            "slicer.ScriptedLoadableModule": scripted_module.make_module(),
            "slicer.parameterNodeWrapper": parameter_node.make_module(),
        }
        for name, module in modules.items():
            self._modules[name] = sys.modules.get(name, _MISSING)
            sys.modules[name] = module
            if name.startswith("slicer."):
                self.set(name.removeprefix("slicer."), module)
        self.set("modules", SimpleNamespace())
        self.set("qSlicerScriptedLoadableModule", qSlicerScriptedLoadableModule)
        self.set("qSlicerScriptedLoadableModuleWidget", scripted_module.WidgetRepresentation)
        for name in OFFERED["qMRML"]:
            try:
                self.set(name, class_named(name))
            except AttributeError:
                continue  # Listed, but not offered yet: the module finds it missing.

    def set(self, name: str, value: Any) -> None:
        """Set an attribute of the package `slicer`."""
        self._attributes.setdefault(name, getattr(slicer, name, _MISSING))
        setattr(slicer, name, value)

    def remove(self) -> None:
        for name, value in self._modules.items():
            if value is _MISSING:
                sys.modules.pop(name, None)
            else:
                sys.modules[name] = value
        for name, value in self._attributes.items():
            if value is _MISSING:
                delattr(slicer, name)
            else:
                setattr(slicer, name, value)


VARIABLES = ("HOME", "USERPROFILE", "APPDATA", "LOCALAPPDATA")
WITHOUT = ("XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_DOCUMENTS_DIR")


class Home:
    """Everything that Qt calls the user's lies in `folder`, until `leave`."""

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self._former = {name: os.environ.get(name) for name in (*VARIABLES, *WITHOUT)}
        for name in VARIABLES:
            os.environ[name] = str(folder)
        for name in WITHOUT:
            os.environ.pop(name, None)
        QStandardPaths.setTestModeEnabled(True)

    def leave(self) -> None:
        for name, value in self._former.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
