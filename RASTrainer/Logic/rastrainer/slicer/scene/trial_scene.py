"""The trial that the scene shows: its touches, where they are registered to, and its results."""

from __future__ import annotations

from functools import partial
from hashlib import sha256
from typing import Any

import numpy as np
import slicer

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.protocol import TRACED_METHODS, RegistrationMethod
from rastrainer.registration.fits import MINIMUM_POINTS, RIGID
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.background_work import CallLater, callNow
from rastrainer.slicer.scene.error_colors import showResidualArrows
from rastrainer.slicer.scene.nodes import TASK_ATTRIBUTE, Role, labelsOf, setPoints
from rastrainer.slicer.scene.robot import placeRobot
from rastrainer.slicer.scene.scenario_nodes import showScenario, showTask, taskKey
from rastrainer.slicer.scene.tables import showFits, showResiduals
from rastrainer.slicer.translation import _
from rastrainer.trial.analysis import TrialAnalysis
from rastrainer.trial.record import TrialRecord

TRACED_ATTRIBUTE = "RASTrainer.tracedMethod"
"""Method of the trial whose touches these are, where the skin is traced after them."""
STORED_ATTRIBUTE = "RASTrainer.storedTouches"
"""Stamp of the touches that were put there from a stored trial, which no simulator will clear."""


def showTouches(scene: Any, record: TrialRecord) -> Any:
    """Show the touches of a stored trial in place of those before; return their list."""
    node = Role.CAPTURED_POINTS.make(scene)
    setPoints(node, record.labels, record.positions_mm)
    node.SetAttribute(STORED_ATTRIBUTE, _stamp(node))
    noteTouchedTask(scene, record.scenario, record.task, record.method)
    setTouchesVisible(scene, True)
    return node


def noteTouchedTask(scene: Any, scenario: str, task: str, method: RegistrationMethod) -> None:
    node = Role.CAPTURED_POINTS.make(scene)
    node.SetAttribute(TASK_ATTRIBUTE, taskKey(scenario, task))
    node.SetAttribute(TRACED_ATTRIBUTE, method.value if method in TRACED_METHODS else None)


def setTouchesVisible(scene: Any, visible: bool) -> None:
    """Show the list of touches, or hide it while a replay shows them one by one."""
    Role.CAPTURED_POINTS.make(scene).SetDisplayVisibility(visible)


def showOnlyTouchesOf(scene: Any, scenario: str, task: str) -> None:
    """Hide touches that belong to another task than the task on display."""
    touched = Role.CAPTURED_POINTS.make(scene).GetAttribute(TASK_ATTRIBUTE)
    setTouchesVisible(scene, touched in (None, taskKey(scenario, task)))


def forgetStoredTouches(scene: Any) -> None:
    """Empty the list if it holds a stored trial's touches: another trial has started."""
    node = Role.CAPTURED_POINTS.make(scene)
    if node.GetAttribute(STORED_ATTRIBUTE) == _stamp(node):
        node.RemoveAllControlPoints()
    node.RemoveAttribute(STORED_ATTRIBUTE)
    setTouchesVisible(scene, True)


def checkSameTask(moving: Any | None, fixed: Any | None) -> None:
    """Check that two lists do not belong to different tasks; a user's list belongs to none."""
    if moving is not None and moving.GetAttribute(TRACED_ATTRIBUTE):
        raise InputError(
            _(
                "The trace over the skin starts from the touched landmarks: the trial is "
                "registered by its trace, and not by them alone."
            )
        )
    tasks = [node.GetAttribute(TASK_ATTRIBUTE) for node in (moving, fixed) if node is not None]
    if len(tasks) == 2 and None not in tasks and tasks[0] != tasks[1]:
        raise InputError(
            _(
                "The touches are of {touched}, the fiducials of {shown}: show the task that was "
                "touched, or touch the one that is shown."
            ).format(touched=tasks[0], shown=tasks[1])
        )


def _stamp(node: Any) -> str:
    points = slicer.util.arrayFromMarkupsControlPoints(node).tobytes()
    return sha256(repr(labelsOf(node)).encode() + points).hexdigest()


MOVING_REFERENCE = "RASTrainer.moving"
FIXED_REFERENCE = "RASTrainer.fixed"
KIND_ATTRIBUTE = "RASTrainer.registration"
PLANNED = "planned"


def showPlannedPlace(scene: Any, scenario: Scenario, fixed: Any) -> Any:
    """Place World as the scenario plans it, and return the WorldToHead transform.

    The head of a trial is placed a little differently; only its registration shows where.
    """
    place = transforms.inverse(scenario.head_to_world), PLANNED
    return placeWorld(scene, *place, Role.CAPTURED_POINTS.make(scene), fixed)


def placeWorld(scene: Any, matrix: np.ndarray, kind: str, moving: Any, fixed: Any) -> Any:
    """Set the WorldToHead transform, which remembers its lists of points, and return its node.

    At first it is applied to the moving points; later that stays as it was.
    """
    node = Role.WORLD_TO_HEAD.make(scene)
    wanted = movingNode(node) is None or isApplied(node)
    # Touches and robot follow it.
    with slicer.util.NodeModify(node):
        node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(matrix))
        node.SetNodeReferenceID(MOVING_REFERENCE, moving.GetID())
        node.SetNodeReferenceID(FIXED_REFERENCE, fixed.GetID())
        node.SetAttribute(KIND_ATTRIBUTE, kind)
    if isApplied(node) != wanted:
        setApplied(node, wanted)
    return node


def movingNode(transformNode: Any) -> Any | None:
    return transformNode.GetNodeReference(MOVING_REFERENCE)


def isApplied(transformNode: Any) -> bool:
    moving = movingNode(transformNode)
    return moving is not None and moving.GetTransformNodeID() == transformNode.GetID()


def setApplied(transformNode: Any, applied: bool) -> None:
    """Show the touched points on the head, or where they are in the robot's World."""
    moving = movingNode(transformNode)
    if moving is not None:
        moving.SetAndObserveTransformNodeID(transformNode.GetID() if applied else None)
        if moving.GetDisplayNode() is not None:
            # On the head, the fiducials next to them have the same numbers.
            moving.GetDisplayNode().SetPointLabelsVisibility(not applied)


def followPlacement(scene: Any) -> None:
    """Show the robot where the touched points are shown: at the head, or in World."""
    node = Role.WORLD_TO_HEAD.find(scene)
    placeRobot(scene, node if node is not None and isApplied(node) else None)


def showTrial(
    scene: Any, scenario: Scenario, analysis: TrialAnalysis, later: CallLater = callNow
) -> None:
    """Replace what the scene shows by this trial, one part after the other by `later`.

    The touches come from its record.
    """
    record, rigid = analysis.record, analysis.rigid
    # Touches that do not register alone say nothing about each other.
    isByTouches = record.method not in TRACED_METHODS
    isEnough = isByTouches and len(rigid.labels) > MINIMUM_POINTS[RIGID]

    def place() -> None:
        touches, fixed = Role.CAPTURED_POINTS.make(scene), findFixed()
        placeWorld(scene, rigid.matrix, rigid.kind, touches, fixed)

    findFixed = partial(showTask, scene, scenario, record.task, record.method)
    showScenario(scene, scenario, later)
    later(findFixed)
    later(partial(showTouches, scene, record))
    later(place)
    later(lambda: showResiduals(scene, rigid, rigid.leave_one_out_mm() if isEnough else None))
    later(partial(showFits, scene, analysis.fits, analysis.target_errors))
    later(partial(showResidualArrows, scene, rigid))
