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
from rastrainer.sections.registration_logic import RegistrationLogic
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.scene.nodes import LINE
from rastrainer.slicer.scene.plan_points import UndoablePoints, placedPoints
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.trial.analysis import TrialAnalysis

LONGEST_NAME = 64
SAME_PLACE_MM = 0.01
"""Touches come as single precision numbers first, and with all digits once a trial is stored."""


@dataclass(frozen=True, eq=False)
class PlanOnImages:
    """The plan: a target, or the entry and the target of a trajectory.

    `ends`, (1, 3) or (2, 3) float, are in RAS mm, `endsWorld` where the registration puts them; the
    target is the last. `expected` is the error there; None if it cannot be predicted.
    """

    name: str
    ends: np.ndarray
    endsWorld: np.ndarray
    expected: TargetError | None

    def isAsGood(self, other: PlanOnImages) -> bool:
        """Return whether both plans have the same points, so that an answer applies to both."""
        pairs = ((self.ends, other.ends), (self.endsWorld, other.endsWorld))
        return all(a.shape == b.shape and np.abs(a - b).max() < SAME_PLACE_MM for a, b in pairs)


class PlanLogic:
    """Reads the plan, sends it to the simulator, and reports errors at the target.

    `changed` emits nothing whenever the answers have changed; `sentence` is the last one about the
    plan.
    """

    def __init__(self, scene: Any, link: Link, registration: RegistrationLogic) -> None:
        self.changed = Signal()
        self.sentence = ""
        self.points = UndoablePoints(scene)
        self._link = link
        self._registration = registration
        self._headToWorld: np.ndarray | None = None
        self._sent: PlanOnImages | None = None
        self._reply: Reply | None = None

    @property
    def isReachable(self) -> bool | None:
        """Whether the robot can carry the plan out; None before it is answered."""
        found = self._reply.data.get("reachable") if self._reply and self._reply.ok else None
        return found if isinstance(found, bool) else None

    @property
    def trueErrorMm(self) -> float | None:
        """How far the registration puts the shown target from where it is, once that is known."""
        if self._sent is None or self._headToWorld is None or not (self._reply and self._reply.ok):
            return None
        there = transforms.apply(self._headToWorld, self._sent.ends)
        return float(np.linalg.norm(self._sent.endsWorld[-1] - there[-1]))

    def read(self, node: Any | None, row: int = -1) -> PlanOnImages:
        """Return the plan that a list of points or a line holds.

        The first point of a line is the entry; `row` says which placed point is the target.
        """
        if node is None:
            raise InputError(_("Place a target or a trajectory, or choose one."))
        placed = placedPoints(node, inRas=True)
        if not placed:
            raise InputError(_("{name} has no point yet: place one.").format(name=node.GetName()))
        points = np.array([point.position for point in placed])
        comparison = self._registration.comparison
        if comparison is None:
            problem = self._registration.problem or _("register the touches first.")
            text = _("There is no registration to map the plan with: {problem}")
            raise InputError(text.format(problem=problem))
        ends = points[[0, -1]] if node.IsA(LINE) and len(points) > 1 else points[[row]]
        expected = None
        with contextlib.suppress(InputError):
            expected = comparison.targetError(ends[-1])
        name = placed[row].label if len(targetsOf(node)) > 1 else node.GetName()
        return PlanOnImages(
            name=(name or _("target"))[:LONGEST_NAME],
            ends=ends,
            endsWorld=transforms.apply(transforms.inverse(comparison.shown.matrix), ends),
            expected=expected,
        )

    def send(self, node: Any | None, row: int = -1) -> None:
        """Show the plan in the simulator and ask whether the robot can carry it out."""
        plan = self.read(node, row)
        *entry, target = plan.endsWorld.tolist()
        arguments: dict[str, Any] = {"positionMm": target, "name": plan.name}
        if entry:
            arguments["entryMm"] = entry[0]
        self._remember(plan, _("Waiting for the simulator's answer."))
        self._link.send(CommandName.PLAN_TARGET, arguments, lambda reply: self._take(reply, plan))

    def follow(self, plan: PlanOnImages | None) -> None:
        """Forget the answer about any plan other than this one, which is shown now."""
        if self._sent is None or (plan is not None and self._sent.isAsGood(plan)):
            return
        isRefused = self._reply is not None and not self._reply.ok
        stale = _("The plan has changed since it was shown in the simulator: show it again.")
        self._remember(None, "" if isRefused else stale)

    def takeTruth(self, analysis: TrialAnalysis) -> None:
        """Accept the true pose of the trial's head, from which true errors follow."""
        self._headToWorld = None if analysis.truth is None else analysis.truth.matrix
        self.changed.emit()

    def forgetTruth(self) -> None:
        """Forget the head and the plan of the former trial: another has just started."""
        self._headToWorld = None
        self._remember(None, "")

    def _remember(self, plan: PlanOnImages | None, sentence: str) -> None:
        self._sent, self._reply, self.sentence = plan, None, sentence
        self.changed.emit()

    def _take(self, reply: Reply, plan: PlanOnImages) -> None:
        if plan is not self._sent:
            return
        self._reply, self.sentence = reply, reply.error
        if reply.ok:
            reason = str(reply.data.get("reason", ""))
            answer = _("The robot can carry it out.") if self.isReachable else reason
            shown = _("The simulator shows the plan. {answer}")
            self.sentence = shown.format(answer=answer).strip()
        self.changed.emit()


def targetsOf(node: Any | None) -> tuple[str, ...]:
    if node is None or node.IsA(LINE):
        return ()
    return tuple(point.label for point in placedPoints(node))
