"""Shows a scenario in the scene: head, images, plan, and the fiducials of a task.

Meshes and images are requested at once, and shown when they have been read.
"""

from __future__ import annotations

from functools import partial
from hashlib import sha256
from pathlib import Path
from typing import Any

import slicer

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.head.volume import read_nrrd
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import Scenario, SkullKind, task_by_method
from rastrainer.slicer.background_work import BackgroundWork, CallLater, callNow
from rastrainer.slicer.polydata import meshPolyData
from rastrainer.slicer.scene import nodes
from rastrainer.slicer.scene.nodes import NodeKind, Role
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _

FIDUCIALS = RegistrationMethod.FIDUCIALS
SKULL_COLOR = (0.95, 0.92, 0.82)
SKIN_OPACITY_OVER_SKULL = 0.5
OUTLINE = {"Visibility2D": True, "SliceIntersectionThickness": 2}
"""Line width of head and skull in slice views: one pixel is hardly visible on an MRI."""


def showScenario(scene: Any, scenario: Scenario, later: CallLater = callNow) -> None:
    """Show head, skull, plan and images, one after the other by `later`.

    Called again, nothing is made or read twice: window, level and what the views show stay as they
    are. Meshes and images come still later, by a `SceneFileLoader`.
    """
    skull, volume = scenario.skull, scenario.volume
    opacity, bone = 1.0 if skull is None else SKIN_OPACITY_OVER_SKULL, "Skull"
    if skull is not None and skull.kind is SkullKind.APPROXIMATION:
        bone = "Skull (approximation)"
    looks: list[dict[str, Any]] = [
        {**OUTLINE, "Color": nodes.SKIN_COLOR, "Opacity": opacity},
        {**OUTLINE, "Color": SKULL_COLOR, "Opacity": 1.0},
        {"AutoWindowLevel": False},
    ]
    if volume is not None:
        looks[-1] |= {"Window": volume.window, "Level": volume.level}
    show = partial(_requestFile, scene, scenario.name)
    later(partial(show, Role.HEAD_MODEL, "Head", scenario.head, looks[0]))
    later(partial(show, Role.SKULL, bone, skull and skull.file, looks[1]))
    later(partial(_showPlan, scene, scenario))
    later(partial(show, Role.HEAD_VOLUME, scenario.title, volume and volume.file, looks[2]))


def showTask(
    scene: Any, scenario: Scenario, taskName: str, method: RegistrationMethod = FIDUCIALS
) -> Any:
    """Show the fiducials of a task, in RAS mm, and return their `vtkMRMLMarkupsFiducialNode`.

    A trial by another method shows its touched landmarks instead.
    """
    task = task_by_method(scenario, taskName, method)
    node = Role.FIXED_FIDUCIALS.find(scene)
    name = taskKey(scenario.name, task.name)
    stamp = f"{name} {sha256(task.fiducials.tobytes()).hexdigest()}"
    if node is None or node.GetAttribute(nodes.CONTENT_ATTRIBUTE) != stamp:
        node = Role.FIXED_FIDUCIALS.make(scene)
        with slicer.util.NodeModify(node):
            node.SetName(f"{task.title} fiducials")
            nodes.setPoints(node, task.labels, task.fiducials)
        node.SetAttribute(nodes.TASK_ATTRIBUTE, name)
        node.SetAttribute(nodes.CONTENT_ATTRIBUTE, stamp)
    return node


def taskKey(scenarioName: str, taskName: str) -> str:
    return f"{scenarioName}/{taskName}"


def _showPlan(scene: Any, scenario: Scenario) -> None:
    """Show the targets, the first of which is where the target error is reported, and the line."""
    targets, line = (scenario.target, *scenario.targets), scenario.trajectory
    names, places = [each.name for each in targets], [each.position_ras for each in targets]
    nodes.setPoints(Role.TARGET.make(scene), names, places)
    if line is None:
        Role.TRAJECTORY.remove(scene)
    else:
        ends = line.entry_ras, line.target_ras
        nodes.setPoints(Role.TRAJECTORY.make(scene, line.name), ("Entry", "Target"), ends)


def showImages(scene: Any) -> None:
    """Show the images of the scenario behind all else again, where others are."""
    node = Role.HEAD_VOLUME.find(scene)
    if node is not None and not requestedFile(node):
        showAsBackground(scene, node)


def showAsBackground(scene: Any, volume: Any, later: CallLater = callNow) -> None:
    """Show a volume behind all else in each slice view, one view after the other by `later`."""
    for composite in nodes.nodesOfClass(scene, "vtkMRMLSliceCompositeNode"):
        later(partial(composite.SetBackgroundVolumeID, volume.GetID()))


FILE_ATTRIBUTE = "RASTrainer.file"
"""On a node without content yet: its file."""


def _requestFile(
    scene: Any, scenario: str, kind: NodeKind, name: str, path: Path | None, look: dict[str, Any]
) -> None:
    """Have a node wait for a file of a scenario unless it shows it; without a file, remove it."""
    if path is None:
        kind.remove(scene)
        return
    # The stamp changes with the file, which is not read for it: this is called before every trial.
    status = path.stat() if path.is_file() else None
    stamp = f"{scenario} {status and (status.st_mtime_ns, status.st_size)}"
    node = kind.find(scene)
    if node is not None and node.GetAttribute(nodes.CONTENT_ATTRIBUTE) is None:
        # The user has made it the head.
        nodes.releaseNode(node)
    elif node is not None and kind.dress(node).GetAttribute(nodes.CONTENT_ATTRIBUTE) == stamp:
        return
    if kind is Role.HEAD_VOLUME:
        kind.remove(scene)
    node = kind.make(scene, name)
    if node.IsA(nodes.MODEL):
        # Another scenario's head does not belong to these points.
        node.SetAndObservePolyData(None)
    node.SetAttribute(nodes.CONTENT_ATTRIBUTE, stamp)
    node.SetAttribute(FILE_ATTRIBUTE, str(path))
    # All at once, and before the surface comes: at each change every view would cut or redraw it.
    nodes.setDisplay(node, **look)


def requestedFile(node: Any | None) -> tuple[str, ...]:
    """Return the file that a node waits for; empty if there is no such node or it is filled."""
    if node is None or not node.GetAttribute(FILE_ATTRIBUTE):
        return ()
    attributes = (
        node.GetAttribute(name) or "" for name in (nodes.CONTENT_ATTRIBUTE, FILE_ATTRIBUTE)
    )
    return (node.GetID(), *attributes)


_SHOWN = {
    Role.HEAD_MODEL: _("No head is shown: {problem}"),
    Role.SKULL: _("No skull is shown: {problem}"),
    Role.HEAD_VOLUME: _("There are no images in the slice views: {problem}"),
}
"""Nodes that show a file, each with the message for an unusable file."""


class SceneFileLoader:
    """Fills the nodes of `showScenario` from files: read in the background, one shown in a turn.

    A node holds the file's content, so that a saved scene contains it. It has no storage node:
    Slicer's *Save* would offer to overwrite the scenario's file.

    Attributes:
        shown: emits each node that has been filled, in a later turn.
        problemFound: emits a sentence if a file cannot be used; its node is removed.
    """

    def __init__(self, scene: Any, work: BackgroundWork) -> None:
        self.shown = Signal()
        self.problemFound = Signal()
        self._scene = scene
        self._work = work
        self._reading: set[tuple[str, ...]] = set()

    def process(self) -> None:
        """Start reading requested files; called about ten times a second."""
        for kind, problem in _SHOWN.items():
            requested = requestedFile(kind.find(self._scene))
            if requested and requested not in self._reading:
                self._reading.add(requested)
                read = read_nrrd if kind is Role.HEAD_VOLUME else _readMesh
                take, refuse = partial(self._take, requested), partial(self._refuse, requested)
                self._work.do(partial(read, Path(requested[-1])), take, partial(refuse, problem))

    def _take(self, requested: tuple[str, ...], found: Any) -> None:
        node = self._awaiting(requested)
        if node is None:
            return
        node.RemoveAttribute(FILE_ATTRIBUTE)
        if isinstance(found, HeadMesh):
            node.SetAndObservePolyData(meshPolyData(found))
        else:
            values, ijkToRas = found
            node.SetIJKToRASMatrix(slicer.util.vtkMatrixFromArray(ijkToRas))
            slicer.util.updateVolumeFromArray(node, values.T)

        def show() -> None:
            if node.GetScene() is self._scene:
                if node.IsA(nodes.VOLUME):
                    showAsBackground(self._scene, node, self._work.later)
                self.shown.emit(node)

        self._work.later(show)

    def _refuse(self, requested: tuple[str, ...], problem: str, error: Exception) -> None:
        node = self._awaiting(requested)
        if node is not None:
            nodes.removeNode(node)
            if isinstance(error, InputError):
                self.problemFound.emit(problem.format(problem=error))

    def _awaiting(self, requested: tuple[str, ...]) -> Any | None:
        """Return the node that still requests this file; None if there is none."""
        self._reading.discard(requested)
        node = self._scene.GetNodeByID(requested[0])
        return node if requestedFile(node) == requested else None


def _readMesh(path: Path) -> HeadMesh:
    mesh = read_head_mesh(path)
    mesh.vertex_normals  # noqa: B018 (computed here, in the background, and kept)
    return mesh
