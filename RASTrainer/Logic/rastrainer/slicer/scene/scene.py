"""Finds and creates our nodes in the scene, and notes on them what they show."""

from __future__ import annotations

from pathlib import Path
from typing import Any

ROLE_ATTRIBUTE = "RASTrainer.role"


class Role:
    """What a node of ours is for. It stays when the node is renamed, saved and loaded again."""

    HEAD_MODEL = "head model"
    HEAD_PREVIEW = "head preview"
    HEAD_SEGMENT = "head segment"
    HEAD_VOLUME = "head volume"
    SKULL = "skull"
    FIXED_FIDUCIALS = "fixed fiducials"
    TARGET = "target"
    TRAJECTORY = "trajectory"
    CAPTURED_POINTS = "captured points"
    SIM_STATE = "simulator state"
    WORLD_TO_HEAD = "world to head"
    RESIDUALS = "residuals"
    RESIDUAL_ARROWS = "residual arrows"
    FITS = "fits"
    HISTORY = "history"
    LEARNING_CURVE = "learning curve"
    CALIBRATION = "calibration"
    SCORE = "score"
    COMPARISON = "comparison"
    MOTION = "motion metrics"
    PLAN_TARGET = "plan target"
    PLAN_TRAJECTORY = "plan trajectory"
    PLAN_LINE = "procedure plan line"
    NO_GO = "procedure no-go structure"
    CHECKPOINTS = "procedure checkpoints"
    PLANNED_LINE = "procedure planned line"
    REGISTERED_LINE = "procedure registered line"
    TRUE_LINE = "procedure true line"
    ERRORS_BY_REGISTRATION = "procedure errors by registration"
    ERRORS_BY_HAND = "procedure errors by hand"
    PROCEDURE_ERRORS = "procedure errors"
    ROBOT = "robot"
    REPLAY = "replay"
    LANDMARKS = "landmarks"
    TRACED_POINTS = "traced points"
    NEXT_PLACE = "next place of the trace"


def findNode(scene: Any, className: str, role: str) -> Any | None:
    """Return the first node of the class with the role, or None."""
    return next(iter(nodesOf(scene, className, role)), None)


def nodesOf(scene: Any, className: str, role: str) -> list[Any]:
    """Return all nodes of the class with the role, in the scene's order."""
    nodes = nodesOfClass(scene, className)
    return [node for node in nodes if node.GetAttribute(ROLE_ATTRIBUTE) == role]


def nodesOfClass(scene: Any, className: str) -> list[Any]:
    """Return all nodes of the class or of classes derived from it, in the scene's order."""
    nodes = scene.GetNodesByClass(className)
    nodes.UnRegister(None)
    return [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]


def removeNode(scene: Any, className: str, role: str) -> None:
    """Remove the node of the class with the role, where there is one."""
    node = findNode(scene, className, role)
    if node is not None:
        scene.RemoveNode(node)


def findOrAddNode(scene: Any, className: str, role: str, name: str) -> Any:
    """Return the node of the class with the role, added under `name` where there is none."""
    node = findNode(scene, className, role)
    if node is None:
        node = scene.AddNewNodeByClass(className, name)
        node.SetAttribute(ROLE_ATTRIBUTE, role)
        if node.IsA("vtkMRMLDisplayableNode"):
            node.CreateDefaultDisplayNodes()
    return node


SCENARIO_ATTRIBUTE = "RASTrainer.scenario"
TASK_ATTRIBUTE = "RASTrainer.task"
CONTENT_ATTRIBUTE = "RASTrainer.content"
"""Stamp of what a node shows: a rebuilt scenario may keep its name."""


def isShown(node: Any, attribute: str, name: str, content: str) -> bool:
    """Return whether a node shows this content of this name."""
    return (node.GetAttribute(attribute), node.GetAttribute(CONTENT_ATTRIBUTE)) == (name, content)


def noteShown(node: Any, attribute: str, name: str, content: str) -> None:
    """Note what a node shows from now on."""
    node.SetAttribute(attribute, name)
    node.SetAttribute(CONTENT_ATTRIBUTE, content)


def stampOf(path: Path) -> str:
    """Return a stamp that changes with a file, without reading it; empty if there is none."""
    if not path.is_file():
        return ""
    status = path.stat()
    return f"{status.st_mtime_ns} {status.st_size}"
