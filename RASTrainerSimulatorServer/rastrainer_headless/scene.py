"""A MRML scene in plain Python: what Slicer's application gives its scene, without the application.

Needs the package `slicer-core`; desktop Slicer has its own scene and never loads this file.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import slicer

from rastrainer.errors import InputError

SLICES = {"Red": "Axial", "Green": "Coronal", "Yellow": "Sagittal"}
"""Slicer's own slice views and how they are cut."""


class HeadlessScene:
    """Owns a `vtkMRMLScene` and the logics without which nodes lose their storage or defaults.

    Attributes:
        scene: the scene, used exactly as `slicer.mrmlScene` is in desktop Slicer.
    """

    def __init__(self) -> None:
        self.scene = slicer.vtkMRMLScene()
        self._applicationLogic = slicer.vtkSlicerApplicationLogic()
        self._applicationLogic.SetMRMLScene(self.scene)
        # It registers the storage of markups: without it, bundles would be saved without points.
        self._markupsLogic = slicer.vtkSlicerMarkupsLogic()
        self._markupsLogic.SetMRMLApplicationLogic(self._applicationLogic)
        self._markupsLogic.SetMRMLScene(self.scene)
        # In a saved scene the slice views show the images.
        self._sliceLogics = [self._sliceLogic(name, axes) for name, axes in SLICES.items()]
        # It shows of each Sequence what its browser has chosen.
        self._sequencesLogic = slicer.vtkSlicerSequencesLogic()
        self._sequencesLogic.SetMRMLApplicationLogic(self._applicationLogic)
        self._sequencesLogic.SetMRMLScene(self.scene)

    def save(self, path: Path) -> None:
        """Write the scene and all its files as one bundle (.mrb), whole or not at all.

        Raises:
            InputError: the bundle cannot be written there.
        """
        messages = slicer.vtkMRMLMessageCollection()
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".saving-") as folder:
            unfinished = Path(folder, path.name)
            if not self.scene.WriteToMRB(str(unfinished), None, messages):
                raise InputError(
                    f"The scene could not be saved as {path}: {messages.GetAllMessagesAsString()}"
                )
            unfinished.replace(path)

    def load(self, path: Path) -> None:
        """Replace the scene by that of a bundle (.mrb).

        Raises:
            InputError: not a bundle that can be read.
        """
        messages = slicer.vtkMRMLMessageCollection()
        with tempfile.TemporaryDirectory() as cacheFolder:
            cache = slicer.vtkCacheManager()
            cache.SetRemoteCacheDirectory(cacheFolder)
            dataIO = slicer.vtkDataIOManager()
            dataIO.SetCacheManager(cache)
            self.scene.SetDataIOManager(dataIO)
            try:
                isRead = self.scene.ReadFromMRB(str(path), True, messages)
            finally:
                self.scene.SetDataIOManager(None)
        if not isRead:
            raise InputError(f"{path} is not a scene bundle (.mrb) that can be read.")

    def _sliceLogic(self, name: str, orientation: str) -> slicer.vtkMRMLSliceLogic:
        logic = slicer.vtkMRMLSliceLogic()
        logic.SetMRMLApplicationLogic(self._applicationLogic)
        logic.SetMRMLScene(self.scene)
        logic.AddSliceNode(name).SetOrientation(orientation)
        return logic
