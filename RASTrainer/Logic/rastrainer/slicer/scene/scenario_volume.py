"""The images of a scenario as a volume node: requested at once, filled when they have been read.

The node holds them itself, so that a saved scene carries them. It has no file of its own: Slicer's
*Save* would offer to write over the scenario's.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.errors import InputError
from rastrainer.files.nrrd import read_nrrd
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.scene import (
    CONTENT_ATTRIBUTE,
    SCENARIO_ATTRIBUTE,
    Role,
    findNode,
    findOrAddNode,
    isShown,
    noteShown,
    removeNode,
    stampOf,
)
from rastrainer.slicer.scene.views import showAsBackground
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

VOLUME = "vtkMRMLScalarVolumeNode"
FILE_ATTRIBUTE = "RASTrainer.volumeFile"
"""Of a node that is not filled yet: the file with its images."""


def requestVolume(scene: Any, scenario: Scenario) -> None:
    """Let the scene have a node for the images of a scenario, or none where it has none.

    Called again, nothing is read twice: window, level and what the views show stay as they are.
    """
    node, file = findNode(scene, VOLUME, Role.HEAD_VOLUME), scenario.volume
    stamp = "" if file is None else stampOf(file.path)
    isThere = node is not None and isShown(node, SCENARIO_ATTRIBUTE, scenario.name, stamp)
    if isThere and file is not None:
        return
    removeNode(scene, VOLUME, Role.HEAD_VOLUME)
    if file is None:
        return
    node = findOrAddNode(scene, VOLUME, Role.HEAD_VOLUME, scenario.title)
    noteShown(node, SCENARIO_ATTRIBUTE, scenario.name, stamp)
    node.SetAttribute(FILE_ATTRIBUTE, str(file.path))
    display = node.GetDisplayNode()
    display.SetAutoWindowLevel(False)
    display.SetWindowLevel(file.window, file.level)


def showImages(scene: Any) -> None:
    """Show the images of the scenario behind all else again, where others are."""
    node = findNode(scene, VOLUME, Role.HEAD_VOLUME)
    if node is not None and not _requested(node):
        showAsBackground(scene, node)


class VolumeLoader:
    """Fills the node of `requestVolume`, and shows it behind all else in the slice views.

    Attributes:
        shown: emits the node when it has been filled.
        problemFound: emits a sentence if the images cannot be used; the node is removed.
    """

    def __init__(self, scene: Any, work: BackgroundWork) -> None:
        """Read in the background of `work`."""
        self.shown = Signal()
        self.problemFound = Signal()
        self._scene = scene
        self._work = work
        self._requested: tuple[str, ...] = ()

    def process(self) -> None:
        """Start reading requested images; called about ten times a second."""
        node = findNode(self._scene, VOLUME, Role.HEAD_VOLUME)
        requested = _requested(node)
        if requested == self._requested:
            return
        self._requested = requested
        if not requested:
            return
        self._work.do(
            lambda: read_nrrd(Path(requested[-1])),
            lambda image: self._take(requested, *image),
            lambda error: self._refuse(requested, error),
        )

    def _take(self, requested: tuple[str, ...], values: np.ndarray, ijkToRas: np.ndarray) -> None:
        # In a cleared scene the next node has the same ID, and may request the same at once.
        self._requested = ()
        node = self._scene.GetNodeByID(requested[0])
        if _requested(node) == requested:
            node.RemoveAttribute(FILE_ATTRIBUTE)
            _fill(node, values, ijkToRas)
            showAsBackground(self._scene, node)
            self.shown.emit(node)

    def _refuse(self, requested: tuple[str, ...], error: Exception) -> None:
        self._requested = ()
        node = self._scene.GetNodeByID(requested[0])
        if _requested(node) == requested:
            self._scene.RemoveNode(node)
            if isinstance(error, InputError):
                sentence = _("There are no images in the slice views: {problem}")
                self.problemFound.emit(sentence.format(problem=error))


def _requested(node: Any | None) -> tuple[str, ...]:
    """Return which images a node is to be filled with, empty where it is filled or not there."""
    if node is None or not node.GetAttribute(FILE_ATTRIBUTE):
        return ()
    attributes = (node.GetAttribute(name) or "" for name in (CONTENT_ATTRIBUTE, FILE_ATTRIBUTE))
    return (node.GetID(), *attributes)


def _fill(node: Any, values: np.ndarray, ijkToRas: np.ndarray) -> None:
    image = vtk.vtkImageData()
    image.SetDimensions(values.shape)
    scalars = numpy_to_vtk(values.ravel(order="F"), deep=True)
    image.GetPointData().SetScalars(scalars)
    node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(ijkToRas))
    node.SetAndObserveImageData(image)
