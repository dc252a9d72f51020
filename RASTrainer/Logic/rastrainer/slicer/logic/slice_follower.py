"""Keeps the slice views where something happens: at the next point of a trial, or at the tool."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from rastrainer.protocol import OPEN_PHASES, DeviceName, Phase
from rastrainer.slicer.logic.training_logic import TrainingLogic, TrialStatus
from rastrainer.slicer.scene.control_points import labelsOf, worldPoints
from rastrainer.slicer.scene.registration_nodes import matrixOf
from rastrainer.slicer.scene.scene import CONTENT_ATTRIBUTE, TASK_ATTRIBUTE, Role, findNode
from rastrainer.slicer.scene.views import AlongInstrument, jumpTo

TRANSFORM, FIDUCIALS = "vtkMRMLLinearTransformNode", "vtkMRMLMarkupsFiducialNode"
LEAST_MOVE_MM = 0.5
PERIOD_S = 0.1
"""Between two jumps after the tool: each renders all slice views."""
LEAST_TURN = 0.01
"""Of the tool, in rad, before the views along it follow."""
DEVICES = {
    Phase.ALIGNING.value: DeviceName.TOOL_TIP_TO_WORLD,
    Phase.DRILLING.value: DeviceName.INSTRUMENT_TIP_TO_WORLD,
    Phase.INSERTING.value: DeviceName.INSTRUMENT_TIP_TO_WORLD,
}
"""Whose pose the views along the instrument follow, by the phase of a procedure."""


class SliceFollower:
    """Moves the slices as far as they must to go through a place; where they look stays.

    While the guide of a procedure is aligned, and drill and instrument are in it, they may lie
    along it instead: one across the instrument (probe's-eye view), two along it.

    Attributes:
        showsNextPoint: whether they jump to each point that is to be touched next.
        followsTool: whether they stay at the tip of the tool, in the place of the next point.
        liesAlong: whether they lie along the instrument of a procedure.
    """

    def __init__(
        self, scene: Any, training: TrainingLogic, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.showsNextPoint = True
        self.followsTool = False
        self.liesAlong = True
        self._along = AlongInstrument(scene)
        self._pose: np.ndarray | None = None
        self._scene = scene
        self._training = training
        self._clock = clock
        self._shownPoint: tuple[str, ...] = ()
        self._place: np.ndarray | None = None
        self._lastJump = -PERIOD_S

    def show(self, place: ArrayLike) -> None:
        """Show a place, (3,) float, RAS mm."""
        self._place = np.array(place, dtype=float)
        self._lastJump = self._clock()
        jumpTo(self._scene, self._place.tolist())

    def showAgain(self) -> None:
        """Show the place that was shown last, after the views were moved."""
        if self._place is not None:
            self.show(self._place)

    def forgetScene(self) -> None:
        """Forget what was shown: the scene was cleared, and its views with it."""
        self._shownPoint, self._place, self._pose = (), None, None
        self._along.forgetScene()

    @property
    def needsPoses(self) -> bool:
        """Whether the slices move with the tool."""
        return self.followsTool or self._device is not None

    def process(self) -> None:
        """Follow what has moved; called about ten times a second."""
        device = self._device
        if device is not None:
            self._shownPoint = ()
            self._lieAlong(device)
            return
        if self._along.isShown:
            if self._training.progress.phase == Phase.PAUSED.value:
                return
            self._along.giveBack()
            self._pose = None
            self.showAgain()
        if self.followsTool:
            self._shownPoint = ()
            self._followTool()
        elif self.showsNextPoint:
            self._showNextPoint()

    @property
    def _device(self) -> str | None:
        """Whose pose the views along the instrument follow; None where they do not."""
        return DEVICES.get(self._training.progress.phase) if self.liesAlong else None

    def _lieAlong(self, device: str) -> None:
        pose = poseOnHead(self._scene, device)
        if pose is None or self._clock() < self._lastJump + PERIOD_S:
            return
        if self._pose is not None and self._along.isShown:
            moved = float(np.linalg.norm(pose[:3, 3] - self._pose[:3, 3]))
            turned = float(np.linalg.norm(pose[:3, 2] - self._pose[:3, 2]))
            if moved < LEAST_MOVE_MM and turned < LEAST_TURN:
                return
        self._pose, self._lastJump = pose, self._clock()
        self._along.show(pose[:3, 3], pose[:3, 2])

    def _followTool(self) -> None:
        tip = toolTip(self._scene)
        if tip is None or self._clock() < self._lastJump + PERIOD_S:
            return
        if self._place is None or np.linalg.norm(tip - self._place) >= LEAST_MOVE_MM:
            self.show(tip)

    def _showNextPoint(self) -> None:
        status = self._training.progress
        fixed = findNode(self._scene, FIDUCIALS, Role.FIXED_FIDUCIALS)
        point = _nextPoint(status, fixed)
        if point == self._shownPoint:
            return
        self._shownPoint = point
        if point and status.nextPoint in labelsOf(fixed):
            self.show(worldPoints(fixed)[labelsOf(fixed).index(status.nextPoint)])


def toolTip(scene: Any) -> np.ndarray | None:
    """Return where the tip of the tool is on the head, (3,) float, RAS mm.

    None where nothing is known of it, or of where the head is.
    """
    pose = poseOnHead(scene, DeviceName.TOOL_TIP_TO_WORLD)
    return None if pose is None else pose[:3, 3]


def poseOnHead(scene: Any, device: str) -> np.ndarray | None:
    """Return the pose of a device on the head, (4, 4) float, RAS mm; z is the tool's axis.

    None where nothing is known of it, or of where the head is.
    """
    pose = findNode(scene, TRANSFORM, device)
    toHead = findNode(scene, TRANSFORM, Role.WORLD_TO_HEAD)
    if pose is None or toHead is None:
        return None
    toWorld = matrixOf(pose)
    if np.array_equal(toWorld, np.eye(4)):
        return None  # No pose has come yet.
    return matrixOf(toHead) @ toWorld


def _nextPoint(status: TrialStatus, fixed: Any | None) -> tuple[str, ...]:
    """Return a key of the next point of a running trial; empty if none is shown.

    The fiducials of a trial that has just started come a moment later than its first point.
    """
    if fixed is None or status.phase not in OPEN_PHASES or not status.nextPoint:
        return ()
    task = fixed.GetAttribute(TASK_ATTRIBUTE) or ""
    if not task.endswith(f"/{status.task}"):
        return ()
    return (task, fixed.GetAttribute(CONTENT_ATTRIBUTE) or "", status.nextPoint)
