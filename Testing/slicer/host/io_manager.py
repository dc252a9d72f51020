"""`slicer.app.coreIOManager()`: scenes are saved as bundles and loaded."""

from __future__ import annotations

from typing import Any

import slicer

from Testing.slicer.host.checked import Checked


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
