"""The record of an aborted trial, as delivered by the simulator and stored in the study.

An aborted trial with touches counts as an attempt: aborting bad trials helps no one to pass.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from rastrainer.json_checks import one_of, whole_number
from rastrainer.procedure.record import Seconds
from rastrainer.protocol import (
    FIDUCIAL_COUNT,
    MAX_TRACE_POINTS,
    MIN_ABORTED_S,
    OPEN_PHASES,
    TRACED_METHODS,
    TRIAL_RUN,
    Phase,
    RegistrationMethod,
)
from rastrainer.trial.record import AnyTrial, Utc


@dataclass(frozen=True, kw_only=True)
class AbortedTrial(AnyTrial):
    """A trial that was started and never registered.

    Attributes:
        elapsed_s: simulated time from the start to the end, or to the last touch where all were
            made; without pauses.
        phase: in which it was aborted: `running`, `paused`, or `complete` after all touches.
        reason: an `AbortReason`, or a later version's reason.
    """

    aborted_utc: Utc
    elapsed_s: Seconds
    phase: Annotated[str, one_of(*(phase.value for phase in OPEN_PHASES))]
    reason: str
    traced: Annotated[int, whole_number(0, MAX_TRACE_POINTS)] = 0

    @property
    def done(self) -> str:
        """How far the trainee came, such as "3 of 15 points touched"."""
        touched = len(self.points)
        if self.method is RegistrationMethod.FIDUCIALS:
            return f"{touched} of {FIDUCIAL_COUNT} points touched"
        landmarks = f"{touched} landmark{'' if touched == 1 else 's'} touched"
        if self.method not in TRACED_METHODS:
            return landmarks
        return f"{landmarks} and {self.traced} points traced"

    @property
    def is_after_all_touches(self) -> bool:
        """Whether all fiducials were touched and only Register was missing."""
        return self.phase == Phase.COMPLETE.value

    @property
    def is_kept(self) -> bool:
        """Whether a study stores it: it has a touch, even a refused one, or took some time."""
        touches = len(self.points) + self.rejected_touches + self.undone_touches
        return touches > 0 or self.elapsed_s > MIN_ABORTED_S

    @property
    def counts_as_failed(self) -> bool:
        """Whether it counts as not passed: a scored task with a kept or undone touch."""
        return self.task != TRIAL_RUN and len(self.points) + self.undone_touches > 0
