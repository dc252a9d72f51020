"""Slicer's views: what the slices show and where, and a layout that is shown for a while."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import slicer

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
