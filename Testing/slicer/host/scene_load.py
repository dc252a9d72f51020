"""Counts what the module hands to the scene in each turn: each call by a click or a timer.

The host cannot measure how long Slicer's views work on that, as they are not drawn here. But they
work in proportion to it, and before the next turn: so all changes in one turn make one stall.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import astuple, dataclass
from typing import Any

import slicer
import vtk

from Testing.slicer.host.values import Slot


@dataclass(frozen=True)
class Load:
    """What one turn, or several, have handed over."""

    events: int = 0
    nodes: int = 0
    kibibytes: int = 0
    cells: int = 0
    views: int = 0

    @classmethod
    def combined(cls, loads: Iterable[Load], function: Any) -> Load:
        """Return the maximum or the sum of loads."""
        return cls(*(function(values) for values in zip(*map(astuple, loads), strict=True)))


class SceneLoad:
    """Counts in a `with` statement."""

    def __init__(self, scene: Any) -> None:
        self._scene = scene
        self._turns: list[Load] = []
        self._tags: list[tuple[Any, int]] = []
        self._known: dict[str, tuple] = {}
        self._added: set[str] = set()
        self._views: set[str] = set()
        self._events = self._kibibytes = self._cells = 0

    def __enter__(self) -> SceneLoad:
        nodes = self._scene.GetNodes()
        for index in range(nodes.GetNumberOfItems()):
            node = nodes.GetItemAsObject(index)
            self._known[node.GetID()] = _data_of(node)
            self._watch(node)
        Slot.watchers.append(self.end_turn)
        event = slicer.vtkMRMLScene.NodeAddedEvent
        self._tags.append((self._scene, self._scene.AddObserver(event, self._add)))
        return self

    def __exit__(self, *_exception: object) -> None:
        Slot.watchers.remove(self.end_turn)
        for node, tag in self._tags:
            node.RemoveObserver(tag)
        self.end_turn()

    @property
    def most(self) -> Load:
        """The most of each in one turn."""
        return Load.combined([Load(), *self._turns], max)

    @property
    def total(self) -> Load:
        return Load.combined([Load(), *self._turns], sum)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _add(self, _scene: Any, _event: str, node: Any) -> None:
        self._added.add(node.GetID())
        self._watch(node)
        self._count(node)

    def _watch(self, node: Any) -> None:
        self._tags.append((node, node.AddObserver("AnyEvent", self._note)))

    def _note(self, node: Any, _event: str) -> None:
        if node is not None:
            self._count(node)

    def _count(self, node: Any) -> None:
        self._events += 1
        known = _data_of(node)
        if known != self._known.get(node.GetID(), ()):
            self._known[node.GetID()] = known
            for data in known[:1]:
                self._kibibytes += data.GetActualMemorySize()
                self._cells += data.GetNumberOfCells() if data.IsA("vtkPolyData") else 0
        if node.IsA("vtkMRMLSliceNode"):
            self._views.add(node.GetID())

    def end_turn(self) -> None:
        """Note that what follows comes in another turn, such as where the application may draw."""
        counts = len(self._added), self._kibibytes, self._cells, len(self._views)
        self._turns.append(Load(self._events, *counts))
        self._events = self._kibibytes = self._cells = 0
        self._views.clear()
        self._added.clear()


def _data_of(node: Any) -> tuple:
    """Return the surface or image of a node and when it has changed; empty if it has none."""
    data = None
    if node.IsA("vtkMRMLModelNode") and not node.GetHideFromEditors():
        data = node.GetPolyData()
    elif node.IsA("vtkMRMLVolumeNode"):
        data = node.GetImageData()
    return () if data is None else (data, data.GetMTime())
