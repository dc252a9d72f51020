"""Whose the touches are that the scene shows; they pair with their own task's fiducials."""

from __future__ import annotations

from hashlib import sha256
from typing import Any

from rastrainer.errors import InputError
from rastrainer.slicer.control_points import labelsOf, localPoints, setPoints
from rastrainer.slicer.link_nodes import capturedPointsNode
from rastrainer.slicer.scenario import TASK_ATTRIBUTE, taskKey
from rastrainer.slicer.translation import _
from rastrainer.trial_record import TrialRecord

STORED_ATTRIBUTE = "RASTrainer.storedTouches"
"""Stamp of the touches that were put there from a stored trial, which no simulator will clear."""


def showTouches(scene: Any, record: TrialRecord) -> Any:
    """Show the touches of a stored trial in place of those before; return their list."""
    node = capturedPointsNode(scene)
    setPoints(node, record.labels, record.positions_mm)
    node.SetAttribute(STORED_ATTRIBUTE, _stamp(node))
    noteTouchedTask(scene, record.scenario, record.task)
    setTouchesVisible(scene, True)
    return node


def noteTouchedTask(scene: Any, scenario: str, task: str) -> None:
    """Note which task the touches that are shown belong to."""
    capturedPointsNode(scene).SetAttribute(TASK_ATTRIBUTE, taskKey(scenario, task))


def setTouchesVisible(scene: Any, visible: bool) -> None:
    """Show the list of touches, or hide it while a replay shows them one by one."""
    display = capturedPointsNode(scene).GetDisplayNode()
    if display is not None:
        display.SetVisibility(visible)


def showOnlyTouchesOf(scene: Any, scenario: str, task: str) -> None:
    """Hide touches that belong to another task than the one that is shown."""
    touched = capturedPointsNode(scene).GetAttribute(TASK_ATTRIBUTE)
    setTouchesVisible(scene, touched in (None, taskKey(scenario, task)))


def forgetStoredTouches(scene: Any) -> None:
    """Empty the list if it holds a stored trial's touches: another trial has begun."""
    node = capturedPointsNode(scene)
    if node.GetAttribute(STORED_ATTRIBUTE) == _stamp(node):
        node.RemoveAllControlPoints()
    node.RemoveAttribute(STORED_ATTRIBUTE)
    setTouchesVisible(scene, True)


def checkSameTask(moving: Any | None, fixed: Any | None) -> None:
    """Check that two lists do not belong to two tasks; of a list of the user's nothing is known.

    Raises:
        InputError: they do.
    """
    tasks = [node.GetAttribute(TASK_ATTRIBUTE) for node in (moving, fixed) if node is not None]
    if len(tasks) == 2 and None not in tasks and tasks[0] != tasks[1]:
        raise InputError(
            _(
                "The touches are of {touched}, the fiducials of {shown}: show the task that was "
                "touched, or touch the one that is shown."
            ).format(touched=tasks[0], shown=tasks[1])
        )


def _stamp(node: Any) -> str:
    content = repr(labelsOf(node)).encode() + localPoints(node).tobytes()
    return sha256(content).hexdigest()
