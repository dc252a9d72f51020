"""Files that nodes are to show: read in the background, and shown one in a turn.

A node is requested at once, and filled when its file has been read. It holds what was in the file
itself, so that a saved scene carries it. It has no file of its own: Slicer's *Save* would offer to
write over the scenario's.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.scene.nodes import (
    CONTENT_ATTRIBUTE,
    SCENARIO_ATTRIBUTE,
    findNode,
    isShown,
    noteShown,
    stampOf,
)
from rastrainer.slicer.signal import Signal

FILE_ATTRIBUTE = "RASTrainer.file"
"""Of a node that is not filled yet: the file that it is to show."""


@dataclass(frozen=True)
class FileContent:
    """What the node of a role shows of its file.

    `read` is called in any thread, and may raise `InputError`; `fill` puts into the node what was
    read; `problem`, with `{problem}`, is for the user of a file that cannot be used.
    """

    className: str
    role: str
    read: Callable[[Path], Any]
    fill: Callable[[Any, Any], None]
    problem: str


def isFileShown(node: Any | None, scenario: str, path: Path | None) -> bool:
    """Return whether a node shows, or is going to, a scenario's file as it is on the disk."""
    if node is None or path is None:
        return False
    return isShown(node, SCENARIO_ATTRIBUTE, scenario, stampOf(path))


def requestFile(node: Any, scenario: str, path: Path) -> None:
    noteShown(node, SCENARIO_ATTRIBUTE, scenario, stampOf(path))
    node.SetAttribute(FILE_ATTRIBUTE, str(path))


class FileLoader:
    """Fills the nodes that `requestFile` was called for.

    Attributes:
        shown: emits each node that has been filled, in a later turn.
        problemFound: emits a sentence if a file cannot be used; its node is removed.
    """

    def __init__(self, scene: Any, work: BackgroundWork, contents: Sequence[FileContent]) -> None:
        """Read `contents` in their order, in the background of `work`."""
        self.shown = Signal()
        self.problemFound = Signal()
        self._scene = scene
        self._work = work
        self._contents = contents
        self._requested: dict[str, tuple[str, ...]] = {}

    def process(self) -> None:
        """Start reading requested files; called about ten times a second."""
        for content in self._contents:
            requested = requestedFile(findNode(self._scene, content.className, content.role))
            if requested != self._requested.get(content.role, ()):
                self._requested[content.role] = requested
                if requested:
                    self._work.do(
                        partial(content.read, Path(requested[-1])),
                        partial(self._take, content, requested),
                        partial(self._refuse, content, requested),
                    )

    def _take(self, content: FileContent, requested: tuple[str, ...], found: Any) -> None:
        node = self._awaiting(content, requested)
        if node is not None:
            node.RemoveAttribute(FILE_ATTRIBUTE)
            content.fill(node, found)
            nodeId = node.GetID()

            def emitShown() -> None:
                node = findNode(self._scene, content.className, content.role)
                if node is not None and node.GetID() == nodeId:
                    self.shown.emit(node)

            self._work.later(emitShown)

    def _refuse(self, content: FileContent, requested: tuple[str, ...], error: Exception) -> None:
        node = self._awaiting(content, requested)
        if node is not None:
            self._scene.RemoveNode(node)
            if isinstance(error, InputError):
                self.problemFound.emit(content.problem.format(problem=error))

    def _awaiting(self, content: FileContent, requested: tuple[str, ...]) -> Any | None:
        """Return the node that still requests this file; None where there is none."""
        # In a cleared scene the next node has the same ID, and may request the same at once.
        self._requested[content.role] = ()
        node = self._scene.GetNodeByID(requested[0])
        return node if requestedFile(node) == requested else None


def requestedFile(node: Any | None) -> tuple[str, ...]:
    """Return which file a node is to show, empty where it is filled or not there."""
    if node is None or not node.GetAttribute(FILE_ATTRIBUTE):
        return ()
    attributes = (node.GetAttribute(name) or "" for name in (CONTENT_ATTRIBUTE, FILE_ATTRIBUTE))
    return (node.GetID(), *attributes)
