"""A scene as Slicer's application keeps it: with the logics that the module relies on."""

from __future__ import annotations

from typing import Any

import slicer

LOGICS = (
    "vtkSlicerMarkupsLogic",
    "vtkSlicerModelsLogic",
    "vtkSlicerVolumesLogic",
    "vtkSlicerTransformLogic",
    "vtkSlicerTablesLogic",
    "vtkSlicerPlotsLogic",
    "vtkSlicerTextsLogic",
    "vtkMRMLColorLogic",
    "vtkSlicerSubjectHierarchyModuleLogic",
    "vtkSlicerSequencesLogic",
)


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
        self._logics: list[Any] = []
        for name in LOGICS:
            if not hasattr(slicer, name):
                continue
            logic = getattr(slicer, name)()
            logic.SetMRMLApplicationLogic(self.applicationLogic)
            logic.SetMRMLScene(self.scene)
            self._logics.append(logic)
