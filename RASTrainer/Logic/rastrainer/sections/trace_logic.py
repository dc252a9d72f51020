"""Shows the trace of the trial that is being played, at most once a second.

That is its points, the covered skin, and where to draw next.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.head.mesh import read_head_mesh
from rastrainer.protocol import Phase
from rastrainer.registration.surface_error import TraceGuide
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.training_logic import TraceStatus, readStatus
from rastrainer.sections.trial_services import Question, Steps, TrialServices
from rastrainer.slicer.polydata import pointCloud
from rastrainer.slicer.scene.error_colors import colorSkin, removeHeadColors
from rastrainer.slicer.scene.nodes import Role, setPoints, surfaceOf
from rastrainer.slicer.scene.scenario_nodes import requestedFile
from rastrainer.slicer.signal import Listening
from rastrainer.slicer.translation import _
from rastrainer.trial.touch_registration import (
    FollowedTrace,
    GivenPoints,
    follow_trace,
    trace_guide,
)

PERIOD_S = 1.0
"""Each time, the whole trace is requested, and the head is redrawn."""
_TRACED_PHASES = (Phase.RUNNING.value, Phase.PAUSED.value, Phase.COMPLETE.value)
DISTANCE_SCALARS = "distance to the trace (mm)"
FARTHEST_MM = 20.0
"""Skin farther from the trace has the color of this distance."""


class TraceLogic(Listening):
    """Asks for the trace as it grows, and shows it on the head while the trial is open.

    Guidance is shown where the trainee sees it, too. All of it is by the landmarks: the head's true
    pose stays unknown.
    """

    def __init__(
        self, services: TrialServices, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self._services = services
        self._clock = clock
        self._scenario: Scenario | None = None
        self._guide: TraceGuide | None = None
        self._wanted: tuple[str, TraceStatus] | None = None
        self._shown: tuple[str, TraceStatus] | None = None
        self._isAsking = False
        self._asked = -PERIOD_S
        super().__init__(
            (services.link.stateChanged, self._follow), (services.link.opened, self._beginAgain)
        )

    def begin(self, scenario: Scenario) -> None:
        """Show traces on the head of a scenario, which is in the scene now."""
        self._scenario, self._guide, self._shown = scenario, None, None

    def forgetScene(self) -> None:
        self._scenario = None

    def process(self) -> None:
        """Ask for the trace if it has changed, and a second has passed."""
        wanted, services = self._wanted, self._services
        isDue = not self._isAsking and self._clock() - self._asked >= PERIOD_S
        if wanted is None or wanted == self._shown or not isDue or not services.link.seen.isOpen:
            return
        # The head that is to be colored may still be being read.
        isReading = requestedFile(Role.HEAD_MODEL.find(services.scene))
        if self._scenario is not None and not isReading:
            self._isAsking, self._asked = True, self._clock()
            services.converse(self._updating(self._scenario, wanted))

    def _follow(self, state: Mapping[str, Any]) -> None:
        trial, wasShown = readStatus(state), self._wanted is not None
        self._wanted = None
        if trial.trace and trial.phase in _TRACED_PHASES and not trial.nextPoint:
            self._wanted = trial.trialId, trial.trace
        if self._wanted is None and wasShown:
            self._shown = None
            forgetTrace(self._services.scene)

    def _beginAgain(self) -> None:
        self._isAsking, self._shown = False, None

    def _updating(self, scenario: Scenario, wanted: tuple[str, TraceStatus]) -> Steps:
        trialId, trace = wanted
        try:
            answer = yield Question(CommandName.GET_TRIAL, {"trialId": trialId})

            def follow() -> FollowedTrace:
                if self._guide is None:
                    self._guide = trace_guide(scenario, read_head_mesh(scenario.head))
                given = GivenPoints.of_answer(answer, least_traced=0)
                return follow_trace(self._guide, scenario, given, trace.on)

            followed = yield follow
        except Exception:
            # Wait for another state: what cannot be shown is reported at registration.
            self._shown = wanted
        else:
            isSameTrial = self._wanted is not None and self._wanted[0] == trialId
            if isSameTrial and self._scenario is scenario:
                self._shown = wanted
                showTrace(self._services.scene, followed, trace.isGuided)
        finally:
            self._isAsking = False


def showTrace(scene: Any, trace: FollowedTrace, isGuided: bool) -> None:
    """Show a trace on the head; to guide, color the distance to it, and mark where to draw next."""
    Role.TRACED_POINTS.make(scene).SetAndObservePolyData(pointCloud(trace.places))
    head = Role.HEAD_MODEL.find(scene)
    if head is not None and not (isGuided and len(trace.places)):
        removeHeadColors(head, DISTANCE_SCALARS)
    elif head is not None:
        near = np.minimum(trace.away_mm, FARTHEST_MM)
        colorSkin(head, DISTANCE_SCALARS, near, (0.0, FARTHEST_MM), _("To trace (mm)"))
    if trace.next_place is None or not isGuided:
        Role.NEXT_PLACE.remove(scene)
    else:
        setPoints(Role.NEXT_PLACE.make(scene), (_("Next"),), trace.next_place[None])


def forgetTrace(scene: Any) -> None:
    Role.TRACED_POINTS.remove(scene)
    Role.NEXT_PLACE.remove(scene)
    head = Role.HEAD_MODEL.find(scene)
    if head is not None and surfaceOf(head):
        removeHeadColors(head, DISTANCE_SCALARS)
        head.GetPolyData().GetPointData().RemoveArray(DISTANCE_SCALARS)
