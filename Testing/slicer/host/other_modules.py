"""The other modules of Slicer's that ours asks for: `slicer.app.moduleManager()`."""

from __future__ import annotations

from typing import Any

from Testing.slicer.host.sample_data import SampleDataLogic


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
    """Finds modules by name; one that is not there is None."""

    def __init__(self, application_logic: Any) -> None:
        self._application_logic = application_logic
        self._modules: dict[str, Any] = {"SampleData": Module("SampleData", SampleDataLogic())}

    def add(self, module: Any) -> None:
        """Add a scripted module under its name."""
        self._modules[module.name] = module

    def module(self, name: str) -> Any | None:
        logic = self._application_logic.GetModuleLogic(name)
        return Module(name, logic) if logic is not None else self._modules.get(name)
