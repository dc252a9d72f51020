"""Takes the time for which the trial run of a study is practiced, and ends its step."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.errors import InputError
from rastrainer.experiment.progress import Progress
from rastrainer.experiment.steps import StepKind
from rastrainer.experiment.study_progress import StudyProgress
from rastrainer.protocol import TRIAL_RUN
from rastrainer.slicer.link import Link
from rastrainer.slicer.trainee_desk import TraineeDesk
from rastrainer.slicer.training_desk import TrainingDesk

KEPT_EVERY_S = 5.0
"""What a crash may cost of the time that a trial run was practiced."""
CLOCK_STEP_S = 0.001
"""The simulator tells the trial's time in steps of so much."""


class PracticeWatch:
    """Counts by the simulator's time of the trial, in which pauses are left out.

    So the simulator, which shows the same minutes to the trainee, and the study agree when they
    are over.
    """

    def __init__(
        self,
        trainees: TraineeDesk,
        training: TrainingDesk,
        link: Link,
        changed: Callable[[str], None],
    ) -> None:
        """`changed` is told of whom a trial run was ended, or no longer goes on."""
        self._trainees = trainees
        self._training = training
        self._link = link
        self._changed = changed
        self._practicing: tuple[str, str] | None = None
        self._seen = self._kept = self._left = 0.0
        self._isFirstSight = True
        link.stateChanged.connect(self._follow)

    def close(self) -> None:
        """Listen no more, and keep what was practiced last."""
        self._link.stateChanged.disconnect(self._follow)
        self.keep()

    def unkept(self, trainee: str, mode: str) -> float:
        """Return how long the trial run was practiced in a mode since it was kept last; s."""
        return self._seen - self._kept if self._practicing == (trainee, mode) else 0.0

    def keep(self) -> None:
        """Put what was practiced into the study's file; the step is done when its time is over."""
        if self._practicing is None:
            return
        (name, _mode), seconds = self._practicing, self._seen - self._kept
        self._kept = self._seen
        progress = self._asked()
        if progress is None:
            self._left = KEPT_EVERY_S
            return
        step = progress.next_step
        try:
            study = StudyProgress(self._trainees.study)
            study.practice(name, step.name, seconds)
            practiced = progress.practiced_s + seconds
            self._left = 60.0 * step.minutes - practiced
            if self._left < CLOCK_STEP_S:
                study.finish(name, step.name, {"minutes": max(practiced / 60.0, step.minutes)})
                self._changed(name)
        except InputError:
            self._practicing = None

    def _follow(self, _state: Mapping[str, Any]) -> None:
        trial = self._training.progress
        isPracticed = trial.isOpen and trial.task == TRIAL_RUN
        practicing = (trial.trainee, trial.mode) if isPracticed else None
        if practicing != self._practicing or (practicing and trial.elapsedS < self._seen):
            self._end()
            self._begin(practicing, trial.elapsedS)
        elif practicing is not None:
            self._seen = trial.elapsedS
            if self._seen - self._kept >= min(KEPT_EVERY_S, self._left):
                self.keep()
        self._isFirstSight = False

    def _begin(self, practicing: tuple[str, str] | None, elapsedS: float) -> None:
        self._practicing, self._seen = practicing, elapsedS
        # What was played before our time may have been counted by the Slicer before this one.
        self._kept = elapsedS if self._isFirstSight else 0.0
        progress = self._asked()
        self._left = KEPT_EVERY_S
        if progress is not None:
            self._left = 60.0 * progress.next_step.minutes - progress.practiced_s

    def _end(self) -> None:
        self.keep()
        ended, self._practicing = self._practicing, None
        if ended is not None:
            self._changed(ended[0])

    def _asked(self) -> Progress | None:
        """Return where the one who practices stands; None where the study asks for no such run."""
        if self._practicing is None:
            return None
        name, mode = self._practicing
        try:
            study = StudyProgress(self._trainees.study)
            progress = study.progress(name) if name in study.enrolled() else None
        except InputError:
            return None
        step = None if progress is None else progress.next_step
        isAsked = step is not None and (step.kind, step.mode) == (StepKind.TRIAL_RUN, mode)
        return progress if isAsked else None
