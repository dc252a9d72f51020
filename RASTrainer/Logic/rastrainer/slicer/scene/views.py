"""Slicer's views: what the slices show and where, and a layout that is shown for a while."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import slicer
import vtk

from rastrainer.slicer.scene.scene import nodesOfClass

LAYOUT_TAG = "vtkMRMLLayoutNode"
WITH_TABLE = slicer.vtkMRMLLayoutNode.SlicerLayoutFourUpTableView
WITH_PLOT = slicer.vtkMRMLLayoutNode.SlicerLayoutConventionalPlotView


def jumpTo(scene: Any, position: Sequence[float]) -> None:
    """Bring a place, (3,) float, RAS mm, into all slice views, which stay where they look."""
    for view in nodesOfClass(scene, "vtkMRMLSliceNode"):
        view.JumpSliceByOffsetting(*position)


def showAsBackground(scene: Any, volume: Any) -> None:
    """Show a volume behind all else in each slice view."""
    for composite in nodesOfClass(scene, "vtkMRMLSliceCompositeNode"):
        composite.SetBackgroundVolumeID(volume.GetID())


PROBES_EYE, IN_LINE, ACROSS = "Red", "Green", "Yellow"
"""Names of the slice views that show the plane across an instrument, and the two along it."""
LEAST_ACROSS = 0.3
"""An instrument that goes along the patient's left-right axis leaves less of it across itself."""


class AlongInstrument:
    """Slice views that lie along an instrument for a while, and are then as they were."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._former: dict[str, vtk.vtkMatrix4x4] = {}

    @property
    def isShown(self) -> bool:
        """Whether the views lie along an instrument."""
        return bool(self._former)

    def show(self, tip: np.ndarray, direction: np.ndarray) -> None:
        """Lay the views through the tip of an instrument.

        The probe's-eye view is across it, seen from outside, the other two are along it, with the
        instrument coming from above; as far as possible, the patient's right is on the left.

        Args:
            tip: (3,) float, RAS mm.
            direction: (3,) float, RAS, unit vector into the head.
        """
        axes = instrumentAxes(direction)
        for view in nodesOfClass(self._scene, "vtkMRMLSliceNode"):
            if view.GetName() not in axes:
                continue
            matrix = view.GetSliceToRAS()
            if view.GetID() not in self._former:
                self._former[view.GetID()] = vtk.vtkMatrix4x4()
                self._former[view.GetID()].DeepCopy(matrix)
            for column, vector in enumerate((*axes[view.GetName()], tip)):
                for row in range(3):
                    matrix.SetElement(row, column, float(vector[row]))
            view.UpdateMatrices()

    def giveBack(self) -> None:
        """Let the views lie as they did before."""
        for viewId, former in self._former.items():
            view = self._scene.GetNodeByID(viewId)
            if view is not None:
                view.GetSliceToRAS().DeepCopy(former)
                view.UpdateMatrices()
        self._former.clear()

    def forgetScene(self) -> None:
        """Forget how the views lay: the scene was cleared."""
        self._former.clear()


def instrumentAxes(direction: np.ndarray) -> dict[str, np.ndarray]:
    """Return the axes of the slice views along an instrument, by the view's name.

    Each is (3, 3) float, RAS: to the right of the view, up in it, and its normal, which go round as
    in Slicer's axial, coronal and sagittal views.

    Args:
        direction: (3,) float, RAS, unit vector into the head.
    """
    outward = -direction
    left = np.array([-1.0, 0.0, 0.0])
    across = left - (left @ outward) * outward
    if np.linalg.norm(across) < LEAST_ACROSS:
        front = np.array([0.0, 1.0, 0.0])
        across = front - (front @ outward) * outward
    across /= np.linalg.norm(across)
    upward = np.cross(across, outward)
    return {
        PROBES_EYE: np.array([across, upward, outward]),
        IN_LINE: np.array([across, outward, upward]),
        ACROSS: np.array([-upward, outward, across]),
    }


class BorrowedLayout:
    """Tables and plots are seen only in a layout that has a view for them."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._purpose = ""
        self._shown = self._former = 0
        self._isOutdated = False

    @property
    def purpose(self) -> str:
        """What the layout is shown for; empty where the views are as the user has them."""
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
        self._isOutdated = False
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

    def forgetScene(self) -> None:
        """Have the next `process` give the layout back: the scene was cleared of what it showed.

        Not yet now, as Slicer shows its last layout again after a scene is closed.
        """
        self._isOutdated = True

    def process(self) -> None:
        """Give the layout back that belongs to a scene which was cleared."""
        if self._isOutdated:
            self._isOutdated = False
            self.giveBack()

    def _node(self) -> Any | None:
        return self._scene.GetSingletonNode(LAYOUT_TAG, LAYOUT_TAG)
