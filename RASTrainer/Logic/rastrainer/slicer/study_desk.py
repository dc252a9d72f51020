"""Leads each trainee through the study's protocol: what comes next, and what became of it."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Callable, Sequence
from datetime import datetime, timezone
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.experiment.progress import Progress
from rastrainer.experiment.steps import Step, StepKind
from rastrainer.experiment.study_progress import StudyProgress
from rastrainer.experiment.study_protocol import StudyProtocol, read_study_protocol
from rastrainer.experiment.study_step import StudyStep
from rastrainer.protocol import TRIAL_RUN, CommandName, Phase
from rastrainer.slicer.link import Link
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.trainee_desk import TraineeDesk
from rastrainer.slicer.training_desk import TrainingDesk
from rastrainer.slicer.translation import _
from rastrainer.study import Study

TRIALS = (StepKind.TRIAL, StepKind.TRIAL_RUN)
KEPT_EVERY_S = 5.0
"""What a crash may cost of the time that a trial run was practiced."""


class StudyDesk:
    """What the Study panel does, for the trainee who is chosen.

    All that is done stands in the study's file before anyone is told, so that whoever opens it
    again goes on where the trainee was. The simulator is told what comes next for each trainee, so
    that its own menu begins nothing else.

    Attributes:
        changed: emits nothing, whenever a step may have been done.
    """

    def __init__(
        self,
        trainees: TraineeDesk,
        training: TrainingDesk,
        link: Link,
        clock: Callable[[], float] = time.monotonic,
        now: Callable[[], datetime] = lambda: datetime.now(timezone.utc),
    ) -> None:
        self.changed = Signal()
        self._trainees = trainees
        self._training = training
        self._link = link
        self._clock = clock
        self._now = now
        self._practicing: tuple[str, str] | None = None
        self._since = 0.0
        self._told: dict[str, StudyStep] = {}
        self._toldStudy: Study | None = None
        trainees.changed.connect(self._count)
        training.changed.connect(self._practice)
        link.opened.connect(self._tellAll)
        self.changed.connect(self._tellNews)

    def close(self) -> None:
        """Listen no more, and keep what was practiced last."""
        self._trainees.changed.disconnect(self._count)
        self._training.changed.disconnect(self._practice)
        self._link.opened.disconnect(self._tellAll)
        self._keep()

    def protocol(self) -> StudyProtocol | None:
        """Return the study's protocol; None where trainees practice freely."""
        return StudyProgress(self._trainees.study).protocol()

    def begin(self, path: Path) -> StudyProtocol:
        """Make a file's protocol that of the study, for good.

        Raises:
            InputError: the file is no protocol, or the study has another one.
        """
        protocol = read_study_protocol(path)
        StudyProgress(self._trainees.study).begin(protocol)
        self.changed.emit()
        return protocol

    def enroll(self) -> int:
        """Give the chosen trainee the first free place in the study's order; the first is 0.

        Raises:
            InputError: nobody is chosen, or the study has no protocol.
        """
        if not self._trainees.chosen:
            raise InputError(_("Choose a trainee in the section Trainees first."))
        place = StudyProgress(self._trainees.study).enroll(self._trainees.chosen)
        self.changed.emit()
        return place

    def progress(self) -> Progress | None:
        """Return where the chosen trainee stands; None for one who practices freely."""
        name = self._trainees.chosen
        study = StudyProgress(self._trainees.study)
        if not name or study.protocol() is None or name not in study.enrolled():
            return None
        return study.progress(name)

    def minutesOver(self, progress: Progress) -> float:
        """Return how much of the next step's time is over: of a trial run, or of a break; min."""
        step = progress.next_step
        if step is None or step.kind not in (StepKind.TRIAL_RUN, StepKind.BREAK):
            return 0.0
        if step.kind is StepKind.BREAK:
            since = datetime.fromisoformat(progress.since_utc)
            return max(0.0, (self._now() - since).total_seconds() / 60.0)
        running = 0.0
        if self._practicing == (self._trainees.chosen, step.name):
            running = self._clock() - self._since
        return (progress.practiced_s + running) / 60.0

    def startTrial(self, task: str, mode: str) -> None:
        """Start a trial for the chosen trainee, unless the study asks for something else first.

        Raises:
            InputError: it does, or no trainee or task is chosen.
        """
        if self.protocol() is not None and self._trainees.chosen:
            self._progress().check_start(mode, task)
        self._training.start(self._trainees.chosen, task, mode)

    def beside(self) -> str:
        """Return a sentence while an enrolled trainee plays what the study has not asked for."""
        trial = self._training.progress
        if not trial.isOpen or trial.trainee not in StudyProgress(self._trainees.study).enrolled():
            return ""
        try:
            progress = StudyProgress(self._trainees.study).progress(trial.trainee)
            progress.check_start(trial.mode, trial.task)
        except InputError:
            return _(
                "{trainee} plays {task} in the mode {mode}, which the study does not ask for now: "
                "it will not count."
            ).format(trainee=trial.trainee, task=trial.task, mode=trial.mode)
        return ""

    def startStep(self) -> None:
        """Start the trial that comes next.

        Raises:
            InputError: no trial comes next.
        """
        step = self._next()
        if step.kind not in TRIALS:
            raise InputError(_("No trial comes next. {step}").format(step=step.sentence))
        self.startTrial(step.task, step.mode)

    def answer(self, answers: Sequence[int]) -> None:
        """Keep the answers of the questionnaire that comes next.

        Raises:
            InputError: none comes next, or an answer is missing.
        """
        self._finish({"answers": list(answers)})

    def finishStep(self) -> None:
        """End the trial run or the break that comes next, once its time is over.

        Raises:
            InputError: it is not, or something else comes next.
        """
        self._keep()
        self._finish({"minutes": self.minutesOver(self._progress())})

    def skipStep(self, reason: str) -> None:
        """Leave the next step out, for a reason that goes into the report.

        Raises:
            InputError: there is no reason of ten characters.
        """
        self._keep()
        step = self._next()
        StudyProgress(self._trainees.study).skip(self._trainees.chosen, step.name, reason)
        self.changed.emit()

    def _finish(self, details: dict) -> None:
        step = self._next()
        StudyProgress(self._trainees.study).finish(self._trainees.chosen, step.name, details)
        self.changed.emit()

    def _progress(self) -> Progress:
        progress = self.progress()
        if progress is None:
            raise InputError(_("Enroll the trainee in the study first."))
        return progress

    def _next(self) -> Step:
        step = self._progress().next_step
        if step is None:
            raise InputError(_("All steps of the study are done."))
        return step

    def _count(self) -> None:
        """Count the trials of the chosen trainee that have arrived meanwhile."""
        # Who looks at the study is told what is wrong with it; the trials are kept.
        with contextlib.suppress(InputError):
            if self.progress() is not None:
                StudyProgress(self._trainees.study).count_played(self._trainees.chosen)
        self.changed.emit()

    def _tellAll(self) -> None:
        """Tell the simulator, which may know nothing yet, what comes next for everybody."""
        self._told.clear()
        with contextlib.suppress(InputError):
            self._toldStudy = self._trainees.study
            for name in StudyProgress(self._toldStudy).enrolled():
                self._tell(name)

    def _tellNews(self) -> None:
        """Tell the simulator what is new of the chosen trainee, and who is led no more."""
        with contextlib.suppress(InputError):
            enrolled = StudyProgress(self._trainees.study).enrolled()
            for name in [name for name in self._told if name not in enrolled]:
                self._send(StudyStep(name))
                del self._told[name]
            if self._trainees.study is not self._toldStudy:
                self._tellAll()
            elif self._trainees.chosen in enrolled:
                self._tell(self._trainees.chosen)

    def _tell(self, name: str) -> None:
        step = StudyStep.of(name, StudyProgress(self._trainees.study).progress(name))
        if self._told.get(name) != step:
            self._told[name] = step
            self._send(step)

    def _send(self, step: StudyStep) -> None:
        # Without a connection nothing is sent; whoever connects is told everything.
        self._link.send(CommandName.STUDY_STEP, step.arguments())

    def _practice(self) -> None:
        """Take the time while the trial run that comes next is being practiced."""
        trial = self._training.progress
        runs = trial.phase == Phase.RUNNING.value and trial.task == TRIAL_RUN
        key = (trial.trainee, f"{trial.mode}/{TRIAL_RUN}") if runs else None
        if key != self._practicing:
            self._keep()
            self._practicing, self._since = key, self._clock()
        elif key is not None and self._clock() - self._since >= KEPT_EVERY_S:
            self._keep()

    def _keep(self) -> None:
        """Put what was practiced into the study's file."""
        if self._practicing is None:
            return
        (name, step), seconds = self._practicing, self._clock() - self._since
        self._since += seconds
        try:
            study = StudyProgress(self._trainees.study)
            upcoming = study.progress(name).next_step if name in study.enrolled() else None
            if upcoming is not None and upcoming.name == step:
                study.practice(name, step, seconds)
        except InputError:
            self._practicing = None
