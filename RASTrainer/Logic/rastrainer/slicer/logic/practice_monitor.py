"""Measures how long the trial run of a study is practiced, and ends its step."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import TRIAL_RUN, StepKind
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.logic.trainee_logic import TraineeLogic
from rastrainer.slicer.logic.training_logic import TrainingLogic
from rastrainer.study.protocol.step_progress import StepProgress
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study_messages import StudyStep

KEPT_EVERY_S = 5.0
"""Most practice time that a crash may lose."""
CLOCK_STEP_S = 0.001
"""Resolution of the trial's time as the simulator sends it."""


class PracticeMonitor:
    """Counts by the simulator's time of the trial, in which pauses are left out.

    So the simulator, which shows the same minutes to the trainee, and the study agree when they
    are over.
    """

    def __init__(
        self,
        trainees: TraineeLogic,
        training: TrainingLogic,
        link: Link,
        changed: Callable[[str], None],
    ) -> None:
        """`changed` is called with the trainee whose trial run has ended or was abandoned."""
        self._trainees = trainees
        self._training = training
        self._link = link
        self._changed = changed
        self._practicing: tuple[str, str] | None = None
        self._trialId = ""
        self._seen = self._kept = self._left = 0.0
        self._isFirstSight = True
        link.stateChanged.connect(self._follow)

    def close(self) -> None:
        self._link.stateChanged.disconnect(self._follow)
        self.keep()

    def leaveStudy(self) -> None:
        """Store the practice time in the study being left; only later practice is for the next."""
        self.keep()
        self._practicing, self._isFirstSight = None, True

    def unsavedS(self, trainee: str, mode: str) -> float:
        """Return how long the trial run was practiced in a mode since it was last stored, s."""
        return self._seen - self._kept if self._practicing == (trainee, mode) else 0.0

    def keep(self) -> None:
        """Store the practice time in the study's file; the step is done when its time is over."""
        if self._practicing is None:
            return
        (name, _mode), seconds = self._practicing, self._seen - self._kept
        self._kept = self._seen
        requested = self._requestedStep()
        if requested is None:
            self._left = KEPT_EVERY_S
            return
        progress, step = requested
        try:
            study = StudyProgress(self._trainees.study)
            study.practice(name, step.name, seconds)
            progress = replace(progress, practiced_s=progress.practiced_s + seconds)
            self._left = progress.practice_left_s
            if self._left < CLOCK_STEP_S:
                minutes = max(progress.practiced_s / 60.0, step.minutes)
                study.finish(name, step.name, {"minutes": minutes})
                self._changed(name)
        except InputError:
            self._practicing = None

    def _follow(self, _state: Mapping[str, Any]) -> None:
        trial = self._training.status
        isPracticed = trial.isOpen and trial.task == TRIAL_RUN
        practicing = (trial.trainee, trial.mode) if isPracticed else None
        isOther = practicing != self._practicing or trial.trialId != self._trialId
        if isOther or (practicing and trial.elapsedS < self._seen):
            self.keep()
            ended, self._practicing = self._practicing, None
            if ended is not None:
                self._changed(ended[0])
            self._trialId = trial.trialId
            self._practicing, self._seen = practicing, trial.elapsedS
            # A previous Slicer may have counted the practice before this one started.
            self._kept = trial.elapsedS if self._isFirstSight else 0.0
            requested = self._requestedStep()
            self._left = KEPT_EVERY_S if requested is None else requested[0].practice_left_s
        elif practicing is not None:
            self._seen = trial.elapsedS
            if self._seen - self._kept >= min(KEPT_EVERY_S, self._left):
                self.keep()
        self._isFirstSight = False

    def _requestedStep(self) -> tuple[StepProgress, StudyStep] | None:
        """Return the progress of the practicing trainee, and the trial run that the study requests.

        None if it requests no such run.
        """
        name, mode = self._practicing or ("", "")
        with contextlib.suppress(InputError):
            progress = StudyProgress(self._trainees.study).progress(name)
            step = progress.next_step
            if step is not None and (step.kind, step.mode) == (StepKind.TRIAL_RUN, mode):
                return progress, step
        return None
