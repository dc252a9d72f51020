"""Leads each trainee through the steps of the study's protocol, and counts the practice time."""

from __future__ import annotations

import contextlib
import logging
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import FREE, TRIAL_RUN, StepKind
from rastrainer.sections.trainees_logic import TraineeLogic
from rastrainer.sections.training_logic import TrainingLogic, TrialStatus
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.signal import Listening, Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import moment
from rastrainer.study.protocol.steps import (
    StepAnswers,
    StepProgress,
    instruction,
    objections_to,
)
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study_messages import StudyStep

KEPT_EVERY_S = 5.0
"""Most practice time that a crash may lose."""
CLOCK_STEP_S = 0.001
"""Resolution of the trial's time as the simulator sends it."""


class PracticeMonitor(Listening):
    """Counts by the simulator's time of the trial, which the trainee sees; it stops in pauses.

    `changed` is called with the trainee whose trial run has ended or was abandoned.
    """

    def __init__(
        self,
        trainees: TraineeLogic,
        training: TrainingLogic,
        link: Link,
        changed: Callable[[str], None],
    ) -> None:
        self._trainees, self._training, self._changed = trainees, training, changed
        self._run: TrialStatus | None = None
        self._kept, self._left = 0.0, KEPT_EVERY_S
        self._isFirstSight = True
        super().__init__((link.stateChanged, self._follow))

    def close(self) -> None:
        super().close()
        self.keep()

    def leaveStudy(self) -> None:
        """Store the practice time in the study being left; only later practice is for the next."""
        self.keep()
        self._run, self._isFirstSight = None, True

    def unsavedS(self, trainee: str, mode: str) -> float:
        """Return how long the trial run was practiced in a mode since it was last stored, s."""
        run = self._run
        if run is None or (run.trainee, run.mode) != (trainee, mode):
            return 0.0
        return run.elapsedS - self._kept

    def keep(self) -> None:
        """Store the practice time in the study's file; the step is done when its time is over."""
        run = self._run
        if run is None:
            return
        seconds, self._kept = run.elapsedS - self._kept, run.elapsedS
        progress = self._requesting(run)
        if progress is None:
            self._left = KEPT_EVERY_S
            return
        try:
            study, step = StudyProgress(self._trainees.study), progress.due()
            study.practice(run.trainee, step.name, seconds)
            progress = replace(progress, practiced_s=progress.practiced_s + seconds)
            self._left = progress.practice_left_s
            if self._left < CLOCK_STEP_S:
                minutes = max(progress.practiced_s / 60.0, step.minutes)
                study.finish(run.trainee, step.name, {"minutes": minutes})
                self._changed(run.trainee)
        except InputError:
            self._run = None

    def _follow(self, _state: Mapping[str, Any]) -> None:
        trial, run = self._training.status, self._run
        isPracticed = trial.isOpen and trial.task == TRIAL_RUN
        whose = trial.trialId, trial.trainee, trial.mode
        isSame = run is not None and (run.trialId, run.trainee, run.mode) == whose
        if run is not None and isPracticed and isSame and trial.elapsedS >= run.elapsedS:
            self._run = trial
            if trial.elapsedS - self._kept >= min(KEPT_EVERY_S, self._left):
                self.keep()
        elif run is not None or isPracticed:
            self.keep()
            ended, self._run = self._run, None
            if ended is not None:
                self._changed(ended.trainee)
            if isPracticed:
                # A previous Slicer may have counted the practice before this one started.
                self._run, self._kept = trial, trial.elapsedS if self._isFirstSight else 0.0
                progress = self._requesting(trial)
                self._left = KEPT_EVERY_S if progress is None else progress.practice_left_s
        self._isFirstSight = False

    def _requesting(self, run: TrialStatus) -> StepProgress | None:
        """Return the progress of the practicing trainee, if its next step is this trial run."""
        with contextlib.suppress(InputError):
            progress = StudyProgress(self._trainees.study).progress(run.trainee)
            step = progress.next_step
            if step is not None and (step.kind, step.mode) == (StepKind.TRIAL_RUN, run.mode):
                return progress
        return None


class StudyLogic(Listening):
    """Work of the section Study for the chosen trainee, and for all enrolled trainees.

    Everything done is in the study's file before anyone is informed, so that the trainee resumes
    there when it is opened again. The simulator is sent the next step of each trainee, chosen
    here or not, so that its menu starts nothing else. Trial runs and breaks end by themselves;
    `process` is to be called once a second, or more often. `changed` emits nothing whenever a step
    may have been done.
    """

    def __init__(
        self,
        trainees: TraineeLogic,
        training: TrainingLogic,
        link: Link,
        now: Callable[[], datetime] = lambda: datetime.now(timezone.utc),
    ) -> None:
        self.changed = Signal()
        self._trainees, self._training, self._link, self._now = trainees, training, link, now
        self._sentSteps: dict[str, StudyStep] = {}
        self._ledStudy: Study | None = None
        self._breaks: dict[str, datetime] = {}
        self._watch = PracticeMonitor(trainees, training, link, self.leadAgain)
        super().__init__(
            (trainees.changed, self._followTrainees),
            # The simulator may know nothing yet.
            (link.opened, self._sentSteps.clear),
            (link.opened, self._followTrainees),
            (link.stepAnswered, self._takeAnswers),
        )

    def close(self) -> None:
        super().close()
        self._watch.close()

    @property
    def study(self) -> StudyProgress:
        return StudyProgress(self._trainees.study)

    def leaveStudy(self) -> None:
        """Save what belongs to the study being left; the next may have the same pseudonyms."""
        self._watch.leaveStudy()
        self._breaks.clear()

    def process(self) -> None:
        """End the breaks whose time is over."""
        now = self._now()
        for name in [name for name, end in self._breaks.items() if now >= end]:
            del self._breaks[name]
            with contextlib.suppress(InputError):
                progress = self.study.progress(name)
                step, end = progress.next_step, progress.break_end
                # Another Slicer may have ended the break already: what follows is no break.
                if step is not None and end is not None and now >= end:
                    self.study.finish(name, step.name, {"minutes": progress.minutes_elapsed(now)})
            self.leadOn(name)

    def begin(self, path: Path) -> None:
        self.study.set_protocol(StudyProtocol.read(path))
        self.changed.emit()

    def enroll(self) -> int:
        """Give the chosen trainee the first free number in the study's order, from 0."""
        place = self.study.enroll(self._trainees.required())
        self.leadOn(self._trainees.chosen)
        return place

    def progress(self) -> StepProgress | None:
        """Return the chosen trainee's progress; None for one who practices freely."""
        name = self._trainees.chosen
        return self.study.progress(name) if name in self.study.enrolled() else None

    def minutesElapsed(self, progress: StepProgress) -> float:
        """Return how much of the chosen trainee's trial run or break is over; min."""
        step, minutes = progress.next_step, progress.minutes_elapsed(self._now())
        if step is None or step.kind != StepKind.TRIAL_RUN:
            return minutes
        return minutes + self._watch.unsavedS(self._trainees.chosen, step.mode) / 60.0

    def startTrial(
        self,
        task: str,
        mode: str,
        isTutorialFirst: bool = True,
        **others: str | Mapping[str, float],
    ) -> None:
        """Start a trial for the chosen trainee, unless the study asks for something else first.

        Within a study, the protocol decides whether a trial run waits for the tutorial, by what a
        trial is registered, how its skin shifts, and whether it continues with a procedure.
        """
        trainee = self._trainees.chosen
        if self.study.protocol() is not None and trainee:
            step = self._progress().check_start(mode, task)
            isTutorialFirst = True
            others = {name: getattr(step, name) for name in ("procedure", "method", "skin")}
        self._training.start(trainee, task, mode, isTutorialFirst, **others)

    def offProtocolSentence(self) -> str:
        """Return a sentence while an enrolled trainee plays what the study has not requested."""
        trial = self._training.status
        if not trial.isOpen or trial.trainee not in self.study.enrolled():
            return ""
        procedure = trial.procedure.name
        text = _(
            "{trainee} is doing {task} by {method} in the mode {mode}, which the study does not "
            "ask for now: it will not count."
        )
        if procedure:
            text = _(
                "{trainee} is doing {task} by {method} with the procedure {procedure} in the mode "
                "{mode}, which the study does not ask for now: it will not count."
            )
        with contextlib.suppress(InputError):
            progress = self.study.progress(trial.trainee)
            if progress.unexplained:
                text = _(
                    "{trainee} is repeating an aborted trial: it will count once a reason is given."
                )
            else:
                step = progress.check_start(trial.mode, trial.task)
                if (step.procedure, step.method) == (procedure, trial.method):
                    return ""
        return text.format(**{**vars(trial), "procedure": procedure})

    def uncountedSentence(self) -> str:
        """Say why the last trial of the kind that comes next did not count; empty if none is so."""
        progress = self.progress()
        if progress is None or progress.next_step is None:
            return ""
        step = progress.next_step
        for trial in reversed(self._trainees.history()):
            record = trial.record
            isBefore = moment(record.started_utc) < moment(progress.enrolled_utc)
            if isBefore or record.trial_id in progress.counted_trials:
                return ""
            procedure = "" if record.procedure is None else record.procedure.procedure
            played = (record.mode, record.task, procedure, record.method.value)
            if played != (step.mode, step.task, step.procedure, step.method):
                continue
            reasons = objections_to(step, record)
            if not reasons and not trial.registrations and trial.score is None:
                reasons = (_("it cannot be registered, and so not scored"),)
            if reasons:
                return _("The last trial did not count: {reasons}.").format(
                    reasons="; ".join(reasons)
                )
        return ""

    def startStep(self) -> None:
        step = self._progress().due()
        if not step.is_played:
            raise InputError(_("No trial comes next. {step}").format(step=instruction(step)))
        self.startTrial(step.task, step.mode)

    def answer(self, answers: Sequence[int]) -> None:
        name, step = self._trainees.chosen, self._progress().due()
        self.study.finish(name, step.name, {"answers": list(answers)})
        self.leadOn(name)

    def skipStep(self, stepName: str, reason: str) -> None:
        self._watch.keep()
        self.study.skip(self._trainees.chosen, stepName, reason)
        self.leadOn(self._trainees.chosen)

    def explainRepeat(self, reason: str) -> None:
        """Say why the next step is played again after it was aborted; it goes into the report."""
        self.study.explain_repeat(self._trainees.chosen, reason)
        self.leadOn(self._trainees.chosen)

    def _progress(self) -> StepProgress:
        progress = self.progress()
        if progress is None:
            raise InputError(_("Enroll the trainee in the study first."))
        return progress

    def _takeAnswers(self, value: Mapping[str, Any]) -> None:
        """Store answers given at the simulator, which repeats them until another step is sent."""
        try:
            answers = record_from_json(StepAnswers, value, "StepAnswered")
            if answers.trainee not in self.study.enrolled():
                return
            progress = self.study.progress(answers.trainee)
            step = progress.next_step
            isAsked = answers.belong_to(progress.study_step(answers.trainee, self._now()))
            if isAsked and step is not None:
                self.study.finish(answers.trainee, step.name, {"answers": answers.answers})
        except InputError as error:
            logging.error("Answers given at the simulator were not stored: %s", error)
        else:
            self.leadAgain(answers.trainee)

    def leadOn(self, name: str) -> None:
        """Update one trainee who has something new, such as a trial, and notify all listeners."""
        with contextlib.suppress(InputError):
            if name in self.study.enrolled():
                self._lead(name)
        self.changed.emit()

    def leadAgain(self, name: str) -> None:
        """Update one trainee, and send the simulator the next step even if it knows it."""
        self._sentSteps.pop(name, None)
        self.leadOn(name)

    def _followTrainees(self) -> None:
        """Update the chosen and any new trainee, or everybody if it is another study."""
        # The section Trainees shows the error.
        with contextlib.suppress(InputError):
            enrolled = self.study.enrolled()
            for name in [name for name in self._sentSteps if name not in enrolled]:
                self._send(StudyStep(name, FREE))
                del self._sentSteps[name]
                self._breaks.pop(name, None)
            isSame = self._trainees.study is self._ledStudy
            self._ledStudy = self._trainees.study
            known = self._sentSteps.keys() - {self._trainees.chosen} if isSame else ()
            for name in [name for name in enrolled if name not in known]:
                with contextlib.suppress(InputError):
                    self._lead(name)
        self.changed.emit()

    def _lead(self, name: str) -> None:
        """Count the trials of a trainee that have arrived, and send the next step if it is new."""
        progress = self.study.count_played(name)
        self._breaks.pop(name, None)
        if progress.break_end is not None:
            self._breaks[name] = progress.break_end
        step = progress.study_step(name, self._now())
        if self._sentSteps.get(name) != step:
            self._sentSteps[name] = step
            self._send(step)

    def _send(self, step: StudyStep) -> None:
        # Without a connection nothing is sent; a new connection is sent everything.
        self._link.send(CommandName.STUDY_STEP, record_to_json(step))
