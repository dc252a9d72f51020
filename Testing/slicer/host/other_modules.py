"""The other modules of Slicer's that ours asks for: `slicer.app.moduleManager()`."""

from __future__ import annotations

from typing import Any

import numpy as np
import slicer


class qSlicerScriptedLoadableModule:
    """`slicer.util` asks for this class; the modules here are of another one."""


class SampleDataLogic:
    """Stands in for the logic of Sample Data, which downloads: the volume is made here."""

    def downloadSample(self, name: str) -> Any:
        values = np.full((8, 8, 8), 100, dtype=np.int16)
        return slicer.util.addVolumeFromArray(values, name=name)


class Module:
    """A module with its logic."""

    def __init__(self, name: str, logic: Any) -> None:
        self.name = name
        self._logic = logic

    def logic(self) -> Any:
        return self._logic


class ModuleManager:
    """Finds modules by name; one that is not there is None."""

    def __init__(self, application_logic: Any) -> None:
        self._application_logic = application_logic
        self._modules = {"SampleData": Module("SampleData", SampleDataLogic())}

    def module(self, name: str) -> Module | None:
        logic = self._application_logic.GetModuleLogic(name)
        return Module(name, logic) if logic is not None else self._modules.get(name)
