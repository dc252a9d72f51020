"""Puts the host's modules where a module of Slicer's looks for them, and removes them again."""

from __future__ import annotations

import os
import sys
from contextlib import ExitStack
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any
from unittest import mock

import slicer
from PySide6.QtCore import QStandardPaths

from Testing.slicer.host import parameter_node, sample_data, scripted_module
from Testing.slicer.host.application import qSlicerScriptedLoadableModule
from Testing.slicer.host.members import OFFERED
from Testing.slicer.host.proxy import class_named, ctk, qt

VARIABLES = ("HOME", "USERPROFILE", "APPDATA", "LOCALAPPDATA")
WITHOUT = ("XDG_DATA_HOME", "XDG_CONFIG_HOME", "XDG_CACHE_HOME", "XDG_DOCUMENTS_DIR")


class Installation:
    """Modules, attributes and the user's home as they were before, until `remove`."""

    def __init__(self, home: Path) -> None:
        """Have everything that Qt calls the user's in the folder `home`."""
        self._changes = ExitStack()
        home.mkdir(parents=True, exist_ok=True)
        kept = {name: value for name, value in os.environ.items() if name not in WITHOUT}
        mine = {**kept, **dict.fromkeys(VARIABLES, str(home))}
        self._changes.enter_context(mock.patch.dict(os.environ, mine, clear=True))
        QStandardPaths.setTestModeEnabled(True)

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
            self._changes.callback(_put_back, name, sys.modules.get(name))
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
        self._changes.enter_context(mock.patch.object(slicer, name, value, create=True))

    def remove(self) -> None:
        self._changes.close()


def _put_back(name: str, module: ModuleType | None) -> None:
    if module is None:
        sys.modules.pop(name, None)
    else:
        sys.modules[name] = module
