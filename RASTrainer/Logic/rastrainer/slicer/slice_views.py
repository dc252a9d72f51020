"""Where the slice views are and what is behind all else, in Slicer and in a scene without views."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any


def jumpTo(scene: Any, position: Sequence[float]) -> None:
    """Bring a place, (3,) float, RAS mm, into all slice views, which stay where they look."""
    for view in _nodes(scene, "vtkMRMLSliceNode"):
        view.JumpSliceByOffsetting(*position)


def showAsBackground(scene: Any, volume: Any) -> None:
    """Show a volume behind all else in each slice view."""
    for composite in _nodes(scene, "vtkMRMLSliceCompositeNode"):
        composite.SetBackgroundVolumeID(volume.GetID())


def _nodes(scene: Any, className: str) -> Iterator[Any]:
    nodes = scene.GetNodesByClass(className)
    nodes.UnRegister(None)
    for index in range(nodes.GetNumberOfItems()):
        yield nodes.GetItemAsObject(index)
