"""Slicer's views: slices at the next point, the tool or an instrument, and a temporary layout."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
import slicer
from numpy.typing import ArrayLike

from rastrainer import transforms
from rastrainer.protocol import DeviceName, Phase
from rastrainer.sections.training_logic import TrainingLogic
from rastrainer.slicer.background_work import CallLater, callNow
from rastrainer.slicer.scene import nodes
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.settings import (
    SLICES_FOLLOW_TOOL,
    SLICES_LIE_ALONG,
    SLICES_SHOW_NEXT_POINT,
    Settings,
)

LAYOUT_TAG = "vtkMRMLLayoutNode"
WITH_TABLE = slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpTableView
WITH_PLOT = slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalPlotView


def jumpTo(scene: Any, position: Sequence[float], later: CallLater = callNow) -> None:
    """Move all slice views to a point, RAS mm, each by `later`: it cuts the images and surfaces."""
    for view in nodes.nodesOfClass(scene, "vtkMRMLSliceNode"):
        later(partial(view.JumpSliceByOffsetting, *position))


class BorrowedLayout:
    """Tables and plots are visible only in a layout that has a view for them."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._purpose = ""
        self._shown = self._former = 0

    @property
    def purpose(self) -> str:
        """Purpose of the shown layout; empty if the user's own layout is shown."""
        node = self._node()
        isShown = node is not None and node.GetViewArrangement() == self._shown
        return self._purpose if isShown else ""

    def show(self, purpose: str, layout: int) -> None:
        """Show a layout, one of `vtkMRMLLayoutNode`'s; without a main window nothing happens."""
        node = self._node()
        if node is None:
            return
        if not self.purpose:
            self._former = node.GetViewArrangement()
        self._purpose, self._shown = purpose, layout
        node.SetViewArrangement(layout)

    def giveBack(self, purpose: str = "") -> None:
        """Show the user's layout again, if ours is shown (for this purpose, if one is given).

        A layout that the user has chosen meanwhile stays.
        """
        node = self._node()
        if node is not None and self.purpose and purpose in ("", self._purpose):
            node.SetViewArrangement(self._former)
            self._purpose = ""

    def _node(self) -> Any | None:
        return self._scene.GetSingletonNode(LAYOUT_TAG, LAYOUT_TAG)


LEAST_MOVE_MM = 0.5
PERIOD_S = 0.09
"""Shortest time between two jumps after the tool: each renders all slice views."""
LEAST_TURN = 0.01
"""Smallest turn of the tool, in rad, that the views along it follow."""
PROBES_EYE, IN_LINE, ACROSS = "Red", "Green", "Yellow"
"""Names of the slice views that show the plane across an instrument, and the two along it."""
LEAST_ACROSS = 0.3
"""An instrument that goes along the patient's left-right axis leaves less of it across itself."""
DEVICES = {
    Phase.ALIGNING.value: DeviceName.TOOL_TIP_TO_WORLD,
    Phase.DRILLING.value: DeviceName.INSTRUMENT_TIP_TO_WORLD,
    Phase.INSERTING.value: DeviceName.INSTRUMENT_TIP_TO_WORLD,
}
"""Whose pose the views along the instrument follow, by the phase of a procedure."""


@dataclass(eq=False)
class SliceFollower:
    """Moves the slices just enough to go through a point; their orientation stays.

    As set, they jump to each point that is to be touched next, or stay at the tip of the tool. In
    a procedure they may lie along guide, drill and instrument, until these are done: one across
    the instrument (probe's-eye view), two along it. `later` has the views moved one after
    the other, where they need not follow the tool.
    """

    scene: Any
    training: TrainingLogic
    settings: Settings
    clock: Callable[[], float] = time.monotonic
    later: CallLater = callNow
    _shownPoint: tuple[str, ...] = ()
    _place: np.ndarray | None = None
    _pose: np.ndarray | None = None
    _unaligned: dict[str, np.ndarray] = field(default_factory=dict)
    _lastJump: float = -PERIOD_S

    def show(self, place: ArrayLike, later: CallLater | None = None) -> None:
        """Show a point, (3,) float, RAS mm."""
        self._place = np.array(place, dtype=float)
        self._lastJump = self.clock()
        jumpTo(self.scene, self._place.tolist(), later or self.later)

    def showAgain(self) -> None:
        if self._place is not None:
            self.show(self._place)

    def forgetScene(self) -> None:
        self._shownPoint, self._place, self._pose = (), None, None
        self._unaligned.clear()

    @property
    def needsPoses(self) -> bool:
        return self.settings.get(SLICES_FOLLOW_TOOL) or self._device is not None

    @property
    def _device(self) -> str | None:
        """Device whose pose the views along the instrument follow; None if they do not."""
        liesAlong = self.settings.get(SLICES_LIE_ALONG)
        return DEVICES.get(self.training.status.phase) if liesAlong else None

    def process(self) -> None:
        device = self._device
        if device is None and self._unaligned:
            if self.training.status.phase == Phase.PAUSED.value:
                return
            self._restoreViews()
            self.showAgain()
        if device is not None or self.settings.get(SLICES_FOLLOW_TOOL):
            self._shownPoint = ()
            pose = poseOnHead(self.scene, device or DeviceName.TOOL_TIP_TO_WORLD)
            if pose is None or self.clock() < self._lastJump + PERIOD_S:
                return
            if device is not None:
                self._alignViews(pose)
            elif _distance(pose[:3, 3], self._place) >= LEAST_MOVE_MM:
                self.show(pose[:3, 3], callNow)
        elif self.settings.get(SLICES_SHOW_NEXT_POINT):
            self._showNextPoint()

    def _alignViews(self, pose: np.ndarray) -> None:
        """Align the views with an instrument, through its tip, where it has moved.

        The probe's-eye view is across it, seen from outside, the other two are along it, with the
        instrument coming from above; as far as possible, the patient's right is on the left.
        """
        former, tip, outward = self._pose, pose[:3, 3], -pose[:3, 2]
        if (
            former is not None
            and _distance(tip, former[:3, 3]) < LEAST_MOVE_MM
            and _distance(outward, -former[:3, 2]) < LEAST_TURN
        ):
            return
        self._pose, self._lastJump = pose, self.clock()
        left, front = np.array([-1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
        across = left - (left @ outward) * outward
        if np.linalg.norm(across) < LEAST_ACROSS:
            across = front - (front @ outward) * outward
        across /= np.linalg.norm(across)
        upward = np.cross(across, outward)
        # Right, up and normal of the view, with the handedness of Slicer's axial, coronal and
        # sagittal views.
        axes = {
            PROBES_EYE: (across, upward, outward),
            IN_LINE: (across, outward, upward),
            ACROSS: (-upward, outward, across),
        }
        for view in nodes.nodesOfClass(self.scene, "vtkMRMLSliceNode"):
            if view.GetName() in axes:
                matrix = view.GetSliceToRAS()
                self._unaligned.setdefault(view.GetID(), slicer.util.arrayFromVTKMatrix(matrix))
                aligned = transforms.rigid(np.column_stack(axes[view.GetName()]), tip)
                slicer.util.updateVTKMatrixFromArray(matrix, aligned)
                view.UpdateMatrices()

    def _restoreViews(self) -> None:
        for view in filter(None, map(self.scene.GetNodeByID, self._unaligned)):
            former = self._unaligned[view.GetID()]
            slicer.util.updateVTKMatrixFromArray(view.GetSliceToRAS(), former)
            view.UpdateMatrices()
        self._unaligned.clear()
        self._pose = None

    def _showNextPoint(self) -> None:
        status = self.training.status
        fixed = Role.FIXED_FIDUCIALS.find(self.scene)
        point: tuple[str, ...] = ()
        task = "" if fixed is None else fixed.GetAttribute(nodes.TASK_ATTRIBUTE) or ""
        # The fiducials of a trial that has just started come a moment later than its first point.
        if fixed and status.isOpen and status.nextPoint and task.endswith(f"/{status.task}"):
            point = (task, fixed.GetAttribute(nodes.CONTENT_ATTRIBUTE) or "", status.nextPoint)
        if point == self._shownPoint:
            return
        self._shownPoint = point
        if point and status.nextPoint in nodes.labelsOf(fixed):
            self.show(nodes.worldPoints(fixed)[nodes.labelsOf(fixed).index(status.nextPoint)])


def _distance(point: np.ndarray, other: np.ndarray | None) -> float:
    return np.inf if other is None else float(np.linalg.norm(point - other))


def poseOnHead(scene: Any, device: str) -> np.ndarray | None:
    """Return the pose of a device on the head, (4, 4) float, RAS mm; z is the tool's axis.

    None if its pose, or the pose of the head, is not known.
    """
    pose = nodes.poseKind(device).find(scene)
    toHead = Role.WORLD_TO_HEAD.find(scene)
    if pose is None or toHead is None:
        return None
    toWorld = slicer.util.arrayFromTransformMatrix(pose)
    if np.array_equal(toWorld, np.eye(4)):
        return None  # No pose has come yet.
    return slicer.util.arrayFromTransformMatrix(toHead) @ toWorld
