"""Shows a scenario in the scene: head, images, what is planned, and the fiducials of a task.

The node of the images is requested at once, and filled when they have been read. It holds them
itself, so that a saved scene carries them. It has no file of its own: Slicer's *Save* would offer
to write over the scenario's.
"""

from __future__ import annotations

from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.volume import read_nrrd
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import Scenario, task_by_method
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.nodes import (
    CONTENT_ATTRIBUTE,
    SCENARIO_ATTRIBUTE,
    TASK_ATTRIBUTE,
    Role,
    findNode,
    findOrAddNode,
    isShown,
    nodesOfClass,
    noteShown,
    removeNode,
    setPoints,
    stampOf,
)
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _


def trianglesPolyData(vertices: np.ndarray, triangles: np.ndarray) -> vtk.vtkPolyData:
    """Return a surface with smooth normals.

    Args:
        vertices: (n, 3) float.
        triangles: (m, 3) int, counterclockwise seen from outside.
    """
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(vertices, dtype=np.float32), deep=True))
    corners = np.ascontiguousarray(triangles, dtype=np.int64).ravel()
    cells = vtk.vtkCellArray()
    cells.SetData(3, numpy_to_vtkIdTypeArray(corners, deep=True))
    surface = vtk.vtkPolyData()
    surface.SetPoints(points)
    surface.SetPolys(cells)
    normals = vtk.vtkTriangleMeshPointNormals()
    normals.SetInputData(surface)
    normals.Update()
    return normals.GetOutput()


SKIN_COLOR = (0.87, 0.72, 0.62)
SKULL_COLOR = (0.95, 0.92, 0.82)
SKIN_OPACITY_OVER_SKULL = 0.5
OUTLINE_PIXELS = 2
"""Of head and skull in the slice views: one is hardly seen on an MRI."""

FIDUCIAL_COLOR = (0.25, 0.55, 0.95)
TARGET_COLOR = (0.2, 0.75, 0.35)


def showScenario(scene: Any, scenario: Scenario) -> None:
    """Show head, skull, targets and trajectory; called again, nothing is made twice.

    The images come later, by a `VolumeLoader`. The first point of the list of targets is the
    scenario's own, at which the target error is reported.

    Raises:
        InputError: a mesh of the scenario cannot be used.
    """
    _showHead(scene, scenario)
    _showSkull(scene, scenario)
    _showTargets(scene, scenario)
    _showTrajectory(scene, scenario)
    requestVolume(scene, scenario)


def showTask(
    scene: Any,
    scenario: Scenario,
    taskName: str,
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS,
) -> Any:
    """Show the fiducials of a task, in RAS mm, and return their `vtkMRMLMarkupsFiducialNode`.

    Of a trial by another method the landmarks that it has touched are shown instead.

    Raises:
        InputError: the scenario has no task of that name, or too few landmarks.
    """
    task = task_by_method(scenario, taskName, method)
    node = findOrAddNode(
        scene, "vtkMRMLMarkupsFiducialNode", Role.FIXED_FIDUCIALS, f"{task.title} fiducials"
    )
    name, digest = taskKey(scenario.name, task.name), sha256(task.fiducials.tobytes()).hexdigest()
    if not isShown(node, TASK_ATTRIBUTE, name, digest):
        _fillFiducials(node, task)
        noteShown(node, TASK_ATTRIBUTE, name, digest)
    return node


def taskKey(scenarioName: str, taskName: str) -> str:
    """Return what `TASK_ATTRIBUTE` says of a list of points that belongs to a task."""
    return f"{scenarioName}/{taskName}"


def _fillFiducials(node: Any, task: Task) -> None:
    node.SetName(f"{task.title} fiducials")
    setPoints(node, task.labels, task.fiducials)
    node.SetLocked(True)
    display = node.GetDisplayNode()
    display.SetSelectedColor(FIDUCIAL_COLOR)
    display.SetGlyphScale(2.0)
    display.SetTextScale(3.5)


def _showHead(scene: Any, scenario: Scenario) -> None:
    node = findOrAddNode(scene, "vtkMRMLModelNode", Role.HEAD_MODEL, "Head")
    opacity = 1.0 if scenario.skull_mesh is None else SKIN_OPACITY_OVER_SKULL
    _fill(node, scenario, scenario.head_mesh, SKIN_COLOR, opacity)


def _showSkull(scene: Any, scenario: Scenario) -> None:
    if scenario.skull_mesh is None:
        removeNode(scene, "vtkMRMLModelNode", Role.SKULL)
        return
    node = findOrAddNode(scene, "vtkMRMLModelNode", Role.SKULL, "Skull")
    if _fill(node, scenario, scenario.skull_mesh, SKULL_COLOR, 1.0):
        node.SetName("Skull (approximation)" if scenario.is_skull_approximate else "Skull")


def _fill(
    node: Any, scenario: Scenario, path: Path, color: tuple[float, float, float], opacity: float
) -> bool:
    """Show a mesh of a scenario; return whether it was not shown before."""
    # Called before every trial: the file is read only if it is not shown yet.
    stamp = stampOf(path)
    if isShown(node, SCENARIO_ATTRIBUTE, scenario.name, stamp):
        return False
    mesh = read_head_mesh(path)
    surface, display = trianglesPolyData(mesh.vertices, mesh.triangles), node.GetDisplayNode()
    # All at once: at each change every view would cut or redraw the surface.
    wasNodeModifying, wasDisplayModifying = node.StartModify(), display.StartModify()
    display.SetColor(color)
    display.SetOpacity(opacity)
    display.SetVisibility2D(True)
    display.SetSliceIntersectionThickness(OUTLINE_PIXELS)
    node.SetAndObservePolyData(surface)
    display.EndModify(wasDisplayModifying)
    node.EndModify(wasNodeModifying)
    noteShown(node, SCENARIO_ATTRIBUTE, scenario.name, stamp)
    return True


def _showTargets(scene: Any, scenario: Scenario) -> None:
    node = findOrAddNode(scene, "vtkMRMLMarkupsFiducialNode", Role.TARGET, "Targets")
    names = [scenario.target_name, *(target.name for target in scenario.targets)]
    places = [scenario.target_position, *(target.position for target in scenario.targets)]
    setPoints(node, names, np.array(places, dtype=float))
    showAsPlanned(node)


def _showTrajectory(scene: Any, scenario: Scenario) -> None:
    planned = scenario.trajectory
    if planned is None:
        removeNode(scene, "vtkMRMLMarkupsLineNode", Role.TRAJECTORY)
        return
    node = findOrAddNode(scene, "vtkMRMLMarkupsLineNode", Role.TRAJECTORY, planned.name)
    node.SetName(planned.name)
    setPoints(node, ("Entry", "Target"), np.array([planned.entry, planned.target], dtype=float))
    showAsPlanned(node)


def showAsPlanned(node: Any) -> None:
    """Show a markups node as part of the plan, which is not moved by hand."""
    node.SetLocked(True)
    node.GetDisplayNode().SetSelectedColor(TARGET_COLOR)


VOLUME = "vtkMRMLScalarVolumeNode"
FILE_ATTRIBUTE = "RASTrainer.volumeFile"
"""Of a node that is not filled yet: the file with its images."""


def requestVolume(scene: Any, scenario: Scenario) -> None:
    """Add a node for the images of a scenario, or remove it if the scenario has none.

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


def showAsBackground(scene: Any, volume: Any) -> None:
    """Show a volume behind all else in each slice view."""
    for composite in nodesOfClass(scene, "vtkMRMLSliceCompositeNode"):
        composite.SetBackgroundVolumeID(volume.GetID())


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
        """Start reading requested images."""
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
            _fillVolume(node, values, ijkToRas)
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


def _fillVolume(node: Any, values: np.ndarray, ijkToRas: np.ndarray) -> None:
    image = vtk.vtkImageData()
    image.SetDimensions(values.shape)
    scalars = numpy_to_vtk(values.ravel(order="F"), deep=True)
    image.GetPointData().SetScalars(scalars)
    node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(ijkToRas))
    node.SetAndObserveImageData(image)
