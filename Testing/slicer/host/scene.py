"""A scene as Slicer's application keeps it: with the logics that the module relies on."""

from __future__ import annotations

from typing import Any

import slicer

MODULE_LOGICS = {
    "Markups": "vtkSlicerMarkupsLogic",
    "Models": "vtkSlicerModelsLogic",
    "Volumes": "vtkSlicerVolumesLogic",
    "Transforms": "vtkSlicerTransformLogic",
    "Tables": "vtkSlicerTablesLogic",
    "Plots": "vtkSlicerPlotsLogic",
    "Texts": "vtkSlicerTextsLogic",
    "Sequences": "vtkSlicerSequencesLogic",
    "SubjectHierarchy": "vtkSlicerSubjectHierarchyModuleLogic",
}


class ApplicationScene:
    """Owns the scene and its logics.

    Attributes:
        scene: what the module sees as `slicer.mrmlScene`.
        applicationLogic: of the application.
    """

    def __init__(self) -> None:
        self.scene = slicer.vtkMRMLScene()
        self.applicationLogic = slicer.vtkSlicerApplicationLogic()
        self.applicationLogic.SetMRMLScene(self.scene)
        # Without its colors a scene has no tables of them; Slicer's own module reads files, too.
        self._colorLogic = slicer.vtkMRMLColorLogic()
        self._colorLogic.SetMRMLScene(self.scene)
        self._logics: list[Any] = [self._prepared(*item) for item in MODULE_LOGICS.items()]

    def _prepared(self, module: str, class_name: str) -> Any:
        logic = getattr(slicer, class_name)()
        logic.SetMRMLApplicationLogic(self.applicationLogic)
        self.applicationLogic.SetModuleLogic(module, logic)
        logic.SetMRMLScene(self.scene)
        return logic
