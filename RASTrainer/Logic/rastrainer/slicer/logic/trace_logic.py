"""Shows the trace of the trial that is being played, at most once a second.

That is its points, the covered skin, and where to draw next.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Reply
from rastrainer.protocol import Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.training_logic import knownNumber
from rastrainer.slicer.scene.error_colors import colorSkin, removeHeadColors
from rastrainer.slicer.scene.nodes import (
    Role,
    drawAsPoints,
    findNode,
    findOrAddNode,
    pointCloud,
    removeNode,
    setPoints,
    surfaceOf,
)
from rastrainer.slicer.scene.scenario_nodes import requestedFile
from rastrainer.slicer.signal import Listening
from rastrainer.slicer.translation import _
from rastrainer.trial.touch_registration import FollowedTrace, GivenPoints, TraceFollower

PERIOD_S = 1.0
"""Each time, the whole trace is requested, and the head is redrawn."""
_TRACED_PHASES = (Phase.RUNNING.value, Phase.PAUSED.value, Phase.COMPLETE.value)


@dataclass(frozen=True)
class _Wanted:
    """What the simulator says about a trace; another one is to be shown."""

    trialId: str
    kept: int
    strokes: int
    isDrawing: bool
    isGuided: bool


class TraceLogic:
    """Asks for the trace as it grows, and shows it on the head while the trial is open.

    Guidance is shown in the scene where the simulator's setting, or the study, has it shown to the
    trainee. All of it is by the landmarks: the head's true pose stays unknown.
    """

    def __init__(
        self,
        scene: Any,
        link: Link,
        work: BackgroundWork,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._scene = scene
        self._link = link
        self._work = work
        self._clock = clock
        self._scenario: Scenario | None = None
        self._follower: TraceFollower | None = None
        self._wanted: _Wanted | None = None
        self._shown: _Wanted | None = None
        self._isAsking = False
        self._asked = -PERIOD_S
        self._listening = Listening(
            (link.stateChanged, self._follow), (link.opened, self._beginAgain)
        )

    def close(self) -> None:
        """Stop listening to the link."""
        self._listening.close()

    def begin(self, scenario: Scenario) -> None:
        """Show traces on the head of a scenario, which is in the scene now."""
        self._scenario, self._follower, self._shown = scenario, None, None

    def forgetScene(self) -> None:
        """Show the trace again: the scene was cleared."""
        self._scenario = None

    def process(self) -> None:
        """Ask for the trace if it has changed, and a second has passed."""
        wanted = self._wanted
        isDue = self._clock() - self._asked >= PERIOD_S
        if wanted is None or wanted == self._shown or self._isAsking or not isDue:
            return
        if self._scenario is None or not self._link.isOpen:
            return
        if requestedFile(findNode(self._scene, MODEL, Role.HEAD_MODEL)):
            # The head that is to be colored is still being read.
            return
        self._isAsking, self._asked = True, self._clock()
        self._link.send(
            CommandName.GET_TRIAL,
            {"trialId": wanted.trialId},
            lambda reply: self._take(reply, wanted),
        )

    def _follow(self, state: Mapping[str, Any]) -> None:
        trace, wasShown = state.get("trace"), self._wanted is not None
        self._wanted = None
        isOpen = state.get("phase") in _TRACED_PHASES and not state.get("nextPoint")
        if isinstance(trace, Mapping) and isOpen:
            self._wanted = _Wanted(
                str(state.get("trialId", "")),
                int(knownNumber(trace.get("kept")) or 0),
                int(knownNumber(trace.get("strokes")) or 0),
                trace.get("on") is True,
                trace.get("isGuided") is True,
            )
        if self._wanted is None and wasShown:
            self._shown = None
            forgetTrace(self._scene)

    def _beginAgain(self) -> None:
        self._isAsking, self._shown = False, None

    def _take(self, reply: Reply, wanted: _Wanted) -> None:
        scenario = self._scenario
        if not reply.ok or scenario is None:
            self._giveUp(wanted)
            return
        self._work.do(
            lambda: self._followed(scenario, reply.data, wanted.isDrawing),
            lambda trace: self._show(trace, wanted),
            lambda _error: self._giveUp(wanted),
        )

    def _followed(
        self, scenario: Scenario, answer: Mapping[str, Any], isDrawing: bool
    ) -> FollowedTrace:
        """Return the trace on the head; called in the background."""
        if self._follower is None:
            self._follower = TraceFollower(scenario)
        return self._follower.follow(GivenPoints.of_answer(answer, least_traced=0), isDrawing)

    def _show(self, trace: FollowedTrace, wanted: _Wanted) -> None:
        self._isAsking = False
        if self._wanted is not None and self._wanted.trialId == wanted.trialId:
            self._shown = wanted
            showTrace(self._scene, trace, wanted.isGuided)

    def _giveUp(self, wanted: _Wanted) -> None:
        """Wait for another state: what cannot be shown is reported at registration."""
        self._isAsking, self._shown = False, wanted


MODEL, MARKUPS = "vtkMRMLModelNode", "vtkMRMLMarkupsFiducialNode"
DISTANCE_SCALARS = "distance to the trace (mm)"
FARTHEST_MM = 20.0
"""What is farther from the trace has the color of this distance."""
NEXT_COLOR = (0.75, 0.0, 0.5)
"""Far from the trace, the head is yellow."""


def showTrace(scene: Any, trace: FollowedTrace, isGuided: bool) -> None:
    """Show a trace on the head, RAS mm.

    Where the trainee is guided, the head is colored by the distance to the trace, and the place to
    draw next is marked.
    """
    node = findOrAddNode(scene, MODEL, Role.TRACED_POINTS, _("Traced points"))
    drawAsPoints(node)
    node.SetAndObservePolyData(pointCloud(trace.places))
    head = findNode(scene, MODEL, Role.HEAD_MODEL)
    if isGuided and len(trace.places):
        _colorHead(head, trace.away_mm)
    elif head is not None:
        removeHeadColors(head, DISTANCE_SCALARS)
    _showNext(scene, trace.next_place if isGuided else None)


def forgetTrace(scene: Any) -> None:
    """Remove everything shown of a trace."""
    removeNode(scene, MODEL, Role.TRACED_POINTS)
    removeNode(scene, MARKUPS, Role.NEXT_PLACE)
    head = findNode(scene, MODEL, Role.HEAD_MODEL)
    if head is not None and surfaceOf(head):
        removeHeadColors(head, DISTANCE_SCALARS)
        head.GetPolyData().GetPointData().RemoveArray(DISTANCE_SCALARS)


def _colorHead(head: Any | None, away_mm: np.ndarray) -> None:
    # Between the trial's scene and this trace another head may have been shown.
    if (
        head is not None
        and surfaceOf(head)
        and head.GetPolyData().GetNumberOfPoints() == len(away_mm)
    ):
        near = np.minimum(away_mm, FARTHEST_MM)
        colorSkin(head, DISTANCE_SCALARS, near, (0.0, FARTHEST_MM), _("To trace (mm)"))


def _showNext(scene: Any, place: np.ndarray | None) -> None:
    if place is None:
        removeNode(scene, MARKUPS, Role.NEXT_PLACE)
        return
    node = findOrAddNode(scene, MARKUPS, Role.NEXT_PLACE, _("Draw here next"))
    setPoints(node, (_("Next"),), place[None])
    node.SetLocked(True)
    display = node.GetDisplayNode()
    display.SetSelectedColor(NEXT_COLOR)
    display.SetGlyphScale(4.0)
    display.SetTextScale(3.5)
    display.SetOccludedVisibility(True)
