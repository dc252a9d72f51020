"""A scene as Slicer's application keeps it: with the logics that the module relies on."""

from __future__ import annotations

import tempfile
from typing import Any

import numpy as np
import slicer

VIRIDIS = ((68, 1, 84), (59, 82, 139), (33, 145, 140), (94, 201, 98), (253, 231, 37))
COLORS = 256
MODULE_LOGICS = {
    "Markups": "vtkSlicerMarkupsLogic",
    "Models": "vtkSlicerModelsLogic",
    "Volumes": "vtkSlicerVolumesLogic",
    "Transforms": "vtkSlicerTransformLogic",
    "Tables": "vtkSlicerTablesLogic",
    "Plots": "vtkSlicerPlotsLogic",
    "Texts": "vtkSlicerTextsLogic",
    "Sequences": "vtkSlicerSequencesLogic",
    "Segmentations": "vtkSlicerSegmentationsModuleLogic",
    "SubjectHierarchy": "vtkSlicerSubjectHierarchyModuleLogic",
}


class ApplicationScene:
    """Owns the scene and its logics."""

    def __init__(self) -> None:
        self.scene = slicer.vtkMRMLScene()
        self.applicationLogic = slicer.vtkSlicerApplicationLogic()
        self.applicationLogic.SetMRMLScene(self.scene)
        # Without its colors a scene has no tables of them; Slicer's own module reads files, too.
        self._colorLogic = slicer.vtkMRMLColorLogic()
        self._colorLogic.SetMRMLScene(self.scene)
        self._cache_folder = tempfile.TemporaryDirectory(prefix="slicer-cache-")
        cache = slicer.vtkCacheManager()
        cache.SetRemoteCacheDirectory(self._cache_folder.name)
        self.scene.SetCacheManager(cache)
        self.scene.RegisterNodeClass(slicer.vtkMRMLColorLegendDisplayNode())
        self.scene.AddNode(_viridis())
        self._logics: list[Any] = [self._prepared(*item) for item in MODULE_LOGICS.items()]

    def _prepared(self, module: str, class_name: str) -> Any:
        logic = getattr(slicer, class_name)()
        logic.SetMRMLApplicationLogic(self.applicationLogic)
        self.applicationLogic.SetModuleLogic(module, logic)
        logic.SetMRMLScene(self.scene)
        return logic


def _viridis() -> Any:
    """Return the color table that Slicer's module Colors reads from a file, near enough."""
    node = slicer.vtkMRMLColorTableNode()
    node.SetSingletonTag("FileViridis.txt")
    node.SetName("Viridis")
    node.SetTypeToUser()
    node.SetNumberOfColors(COLORS)
    known, shares = np.linspace(0.0, 1.0, len(VIRIDIS)), np.linspace(0.0, 1.0, COLORS)
    channels = [np.interp(shares, known, channel) / 255.0 for channel in zip(*VIRIDIS, strict=True)]
    for index, color in enumerate(zip(*channels, strict=True)):
        node.SetColor(index, f"{index}", *color, 1.0)
    return node
