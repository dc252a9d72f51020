"""The base classes of a scripted module: `slicer.ScriptedLoadableModule`."""

from __future__ import annotations

import unittest
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any

import slicer

from Testing.slicer.host.proxy import class_named

_PROPERTIES = """
    title categories dependencies contributors helpText acknowledgementText icon hidden path index
    associatedNodeTypes widgetRepresentationCreationEnabled name
"""


class WidgetRepresentation:
    """Stands in for `qSlicerScriptedLoadableModuleWidget`, as `slicer.util` asks for it."""

    def __init__(self, widget: Any) -> None:
        self._widget = widget

    def self(self) -> Any:
        return self._widget


class ModuleDescription:
    """What Slicer hands to a module as its parent; an unknown attribute raises, as there."""

    __slots__ = (*_PROPERTIES.split(), "_make_widget")

    def __init__(self, name: str, path: Path, make_widget: Callable[[], Any]) -> None:
        """`make_widget` returns the module's widget, made and set up by the first call."""
        self.name = name
        self.path = str(path)
        self._make_widget = make_widget

    def widgetRepresentation(self) -> WidgetRepresentation:
        return WidgetRepresentation(self._make_widget())


class ScriptedLoadableModule:
    """Base of the module."""

    def __init__(self, parent: ModuleDescription) -> None:
        self.parent = parent
        self.moduleName = type(self).__name__
        parent.title = ""
        parent.categories = []
        parent.dependencies = []
        parent.contributors = []
        parent.helpText = ""
        parent.acknowledgementText = ""


class ScriptedLoadableModuleWidget:
    """Base of the module's widget."""

    def __init__(self, parent: Any = None) -> None:
        self.moduleName = type(self).__name__.removesuffix("Widget")
        if parent is None:
            parent = class_named("qSlicerScriptedLoadableModuleWidget")()
            parent.setMRMLScene(slicer.mrmlScene)
        self.parent = parent
        self.layout = parent.layout()
        self.developerMode = False

    def resourcePath(self, filename: str) -> str:
        folder = Path(getattr(slicer.modules, self.moduleName.lower()).path).parent
        return str(folder / "Resources" / filename)

    def setup(self) -> None:
        """The section for developers is not shown."""

    def cleanup(self) -> None:
        """Called when the module is closed."""


class ScriptedLoadableModuleLogic:
    """Base of the module's logic."""

    def __init__(self, parent: Any = None) -> None:
        self.parent = parent
        self.moduleName = type(self).__name__.removesuffix("Logic")
        self.isSingletonParameterNode = True

    def getParameterNode(self) -> Any:
        node = slicer.mrmlScene.GetSingletonNode(self.moduleName, "vtkMRMLScriptedModuleNode")
        return node or self.createParameterNode()

    def createParameterNode(self) -> Any:
        own, name = self.moduleName, slicer.mrmlScene.GenerateUniqueName(self.moduleName)
        node = slicer.vtkMRMLScriptedModuleNode(singleton_tag=own, module_name=own, name=name)
        return slicer.mrmlScene.AddNode(node)


class ScriptedLoadableModuleTest(unittest.TestCase):
    """Base of the module's self tests; they run by `runTest`, which is not to be overridden."""

    def runTest(self) -> None:
        """Run all functions whose name begins with `test_`."""
        for name in unittest.TestLoader().getTestCaseNames(type(self)):
            self.setUp()
            getattr(self, name)()
            self.tearDown()

    def delayDisplay(self, message: str, requestedDelay: Any = None, msec: int = 100) -> None:
        """Slicer shows the message briefly."""


def make_module() -> ModuleType:
    module = ModuleType("slicer.ScriptedLoadableModule")
    for kind in (
        ScriptedLoadableModule,
        ScriptedLoadableModuleWidget,
        ScriptedLoadableModuleLogic,
        ScriptedLoadableModuleTest,
    ):
        setattr(module, kind.__name__, kind)
    return module
