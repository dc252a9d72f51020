"""Notes on our nodes about what they show, so that nothing is read and filled in twice."""

from __future__ import annotations

from pathlib import Path
from typing import Any

SCENARIO_ATTRIBUTE = "RASTrainer.scenario"
TASK_ATTRIBUTE = "RASTrainer.task"
CONTENT_ATTRIBUTE = "RASTrainer.content"
"""Stamp of what a node shows: a scenario that is built anew may keep its name."""


def isShown(node: Any, attribute: str, name: str, content: str) -> bool:
    """Tell whether a node shows this content of this name."""
    return (node.GetAttribute(attribute), node.GetAttribute(CONTENT_ATTRIBUTE)) == (name, content)


def noteShown(node: Any, attribute: str, name: str, content: str) -> None:
    """Note what a node shows from now on."""
    node.SetAttribute(attribute, name)
    node.SetAttribute(CONTENT_ATTRIBUTE, content)


def stampOf(path: Path) -> str:
    """Tell a file from what it was, without reading it; empty where there is none."""
    if not path.is_file():
        return ""
    status = path.stat()
    return f"{status.st_mtime_ns} {status.st_size}"
