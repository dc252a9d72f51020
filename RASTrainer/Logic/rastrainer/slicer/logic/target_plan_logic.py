"""A target or trajectory placed on the MRI, mapped through the registration to the robot."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.registration.target_error import TargetError
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.registration_logic import RegistrationLogic
from rastrainer.slicer.scene.nodes import labelOf, worldPoints
from rastrainer.slicer.scene.plan_points import LINE, PlanPoints, placedRows
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.trial.analysis import TrialAnalysis

LONGEST_NAME = 64
SAME_PLACE_MM = 0.01
"""Touches come as single precision numbers first, and with all digits once a trial is stored."""


@dataclass(frozen=True)
class PlanOnImages:
    """What is planned, on the MRI and in the robot's World, mm.

    Attributes:
        target: (3,) float, RAS.
        entry: (3,) float, RAS, where a trajectory begins; None where only a point is planned.
        targetWorld, entryWorld: where the registration puts them.
        expected: the error to expect there; None if the registration cannot predict it.
    """

    name: str
    target: np.ndarray
    entry: np.ndarray | None
    targetWorld: np.ndarray
    entryWorld: np.ndarray | None
    expected: TargetError | None

    def isAsGood(self, other: PlanOnImages) -> bool:
        """Return whether both plans have the same points, so that an answer applies to both."""
        if (self.entry is None) != (other.entry is None):
            return False
        mine = (self.target, self.targetWorld, self.entry, self.entryWorld)
        theirs = (other.target, other.targetWorld, other.entry, other.entryWorld)
        pairs = [(a, b) for a, b in zip(mine, theirs, strict=True) if a is not None]
        return all(float(np.abs(a - b).max()) < SAME_PLACE_MM for a, b in pairs)


class PlanLogic:
    """What the Plan panel does.

    Attributes:
        changed: emits nothing, whenever the answers below have changed.
        isReachable: whether the robot can carry the plan out; None before it is answered.
        sentence: what was last said about the plan.
        trueErrorMm: how far the registration puts the target from where it is; None until
            the simulator has revealed it.
    """

    def __init__(self, scene: Any, link: Link, registration: RegistrationLogic) -> None:
        self.changed = Signal()
        self.isReachable: bool | None = None
        self.sentence = ""
        self.trueErrorMm: float | None = None
        self.points = PlanPoints(scene)
        self._link = link
        self._registration = registration
        self._headToWorld: np.ndarray | None = None
        self._sent: PlanOnImages | None = None
        self._isAnswered = self._isRefused = False

    def read(self, node: Any | None, row: int = -1) -> PlanOnImages:
        """Return the plan that a list of points or a line holds.

        The first point of a line is the entry; `row` says which placed point is the target.
        """
        if node is None:
            raise InputError(_("Place a target or a trajectory, or choose one."))
        rows = placedRows(node)
        if not rows:
            raise InputError(_("{name} has no point yet: place one.").format(name=node.GetName()))
        points = worldPoints(node)[rows]
        comparison = self._registration.comparison
        if comparison is None:
            raise InputError(
                _("There is no registration to map the plan with: {problem}").format(
                    problem=self._registration.problem or _("register the touches first.")
                )
            )
        toWorld = transforms.inverse(comparison.shown.matrix)
        target = points[row]
        entry = points[0] if node.IsA(LINE) and len(points) > 1 else None
        expected = None
        with contextlib.suppress(InputError):
            expected = comparison.targetError(target)
        names = targetsOf(node)
        return PlanOnImages(
            name=((names[row] if len(names) > 1 else node.GetName()) or _("target"))[:LONGEST_NAME],
            target=target,
            entry=entry,
            targetWorld=transforms.apply(toWorld, target[None])[0],
            entryWorld=None if entry is None else transforms.apply(toWorld, entry[None])[0],
            expected=expected,
        )

    def send(self, node: Any | None, row: int = -1) -> None:
        """Show the plan in the simulator and ask whether the robot can carry it out."""
        plan = self.read(node, row)
        arguments: dict[str, Any] = {"positionMm": plan.targetWorld.tolist(), "name": plan.name}
        if plan.entryWorld is not None:
            arguments["entryMm"] = plan.entryWorld.tolist()
        self.isReachable, self.sentence = None, _("Waiting for the simulator's answer.")
        self.trueErrorMm = None
        self._sent, self._isAnswered, self._isRefused = plan, False, False
        self._link.send(CommandName.PLAN_TARGET, arguments, lambda reply: self._take(reply, plan))
        self.changed.emit()

    def follow(self, plan: PlanOnImages | None) -> None:
        """Forget the answer about any plan other than this one, which is shown now."""
        if self._sent is None or (plan is not None and self._sent.isAsGood(plan)):
            return
        self._sent = self.isReachable = self.trueErrorMm = None
        stale = _("The plan has changed since it was shown in the simulator: show it again.")
        self.sentence = "" if self._isRefused else stale
        self.changed.emit()

    def takeTruth(self, analysis: TrialAnalysis) -> None:
        """Accept the true pose of the trial's head, from which true errors follow."""
        self._headToWorld = None if analysis.truth is None else analysis.truth.matrix
        self._updateTrueError()

    def forgetTruth(self) -> None:
        """Forget the head and the plan of the trial before the one that has just started."""
        self._headToWorld = self._sent = self.isReachable = self.trueErrorMm = None
        self.sentence = ""
        self.changed.emit()

    def _take(self, reply: Reply, plan: PlanOnImages) -> None:
        if plan is not self._sent:
            return
        if not reply.ok:
            self._isRefused, self.sentence = True, reply.error
            self.changed.emit()
            return
        isReachable = reply.data.get("reachable")
        self.isReachable = isReachable if isinstance(isReachable, bool) else None
        reason = str(reply.data.get("reason", ""))
        answer = _("The robot can carry it out.") if self.isReachable else reason
        self.sentence = _("The simulator shows the plan. {answer}").format(answer=answer).strip()
        self._isAnswered = True
        self._updateTrueError()

    def _updateTrueError(self) -> None:
        if self._isAnswered and self._sent is not None and self._headToWorld is not None:
            there = transforms.apply(self._headToWorld, self._sent.target[None])[0]
            self.trueErrorMm = float(np.linalg.norm(self._sent.targetWorld - there))
        self.changed.emit()


def targetsOf(node: Any | None) -> tuple[str, ...]:
    if node is None or node.IsA(LINE):
        return ()
    return tuple(labelOf(node, row) for row in placedRows(node))
