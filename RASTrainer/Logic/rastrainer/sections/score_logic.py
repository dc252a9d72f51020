"""Feedback on a trial, and the replay of a trial or of its worst touch."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.journal.recording import ReplayTrack
from rastrainer.registration.fits import RIGID
from rastrainer.sections.trial_services import TrialServices
from rastrainer.slicer.background_work import inBackground
from rastrainer.slicer.scene.robot_description import URDF, toolPoses
from rastrainer.slicer.scene.scenario_nodes import showScenario, showTask
from rastrainer.slicer.scene.trial_replay import (
    TRIAL_ATTRIBUTE,
    emptyReplay,
    findReplay,
    goTo,
    isReplayOf,
    moment,
    showReplay,
)
from rastrainer.slicer.scene.trial_scene import setTouchesVisible, showTouches
from rastrainer.slicer.signal import Signal
from rastrainer.slicer.translation import _
from rastrainer.study.database.values import StoredTrial
from rastrainer.study.delivered_trial import EXPLAIN, EXPLAIN_PROCEDURE, READ_TRACK, with_progress
from rastrainer.trial.trial_feedback import TrialFeedback
from rastrainer.work_progress import Progress, no_progress

SLICES_A_TURN = 4
"""States of a closed scene's replay, which are released gradually."""


@dataclass(eq=False)
class ReplayLogic:
    """Feedback on stored trials, and their replay, for which the journals must be here.

    `robot` is the folder of the URDF. A trial that `isBeingScored` gets its feedback with its
    score.

    Attributes:
        feedbackFound: emits nothing, whenever the feedback on another trial is known.
        shown: emits nothing, whenever another trial is shown, with its touches to be registered.
        procedureShown: emits `ProcedureOutcome`, `ProcedureRecord` and `RevealedTruth` of that
            trial; None for each that it has not.
        isReleasing: whether states of a closed scene's replay are left, which `process` releases.
    """

    services: TrialServices
    robot: Path
    isTrialOpen: Callable[[], bool]
    isBeingScored: Callable[[str], bool]
    feedbackFound: Signal = field(default_factory=Signal)
    shown: Signal = field(default_factory=Signal)
    procedureShown: Signal = field(default_factory=Signal)
    isReleasing: bool = False
    _awaitedId: str = ""
    _requestedId: str = ""
    _known: tuple[str, TrialFeedback | Exception | None] = "", None
    _until: float | None = None
    _outdated: Iterator[None] = field(default_factory=lambda: iter(()))

    def feedback(self, trial: StoredTrial) -> TrialFeedback | None:
        """Return the feedback on a trial; None while it is being prepared."""
        trialId, work = trial.record.trial_id, self.services.work
        if self._known[0] == trialId:
            if isinstance(self._known[1], Exception):
                raise self._known[1]
            return self._known[1]
        if self.isBeingScored(trialId):
            self._awaitedId = trialId
        elif self._requestedId != trialId:
            self._requestedId = trialId

            def take(found: TrialFeedback | Exception) -> None:
                if self._requestedId == trialId:
                    self.takeFeedback(trialId, found)

            work.do(lambda: self._judge(trial, work.checkWanted), take, take)
        return None

    def takeFeedback(self, trialId: str, feedback: TrialFeedback | Exception) -> None:
        """Accept feedback on a trial that was prepared elsewhere."""
        self._known, self._requestedId, self._awaitedId = (trialId, feedback), "", ""
        self.feedbackFound.emit()

    def retryFeedback(self) -> None:
        """Forget why there was no feedback: the study or the scenarios may have changed."""
        if isinstance(self._known[1], Exception):
            self._known = ("", None)

    def keepStates(self) -> None:
        """Have the states of the replay released slice by slice, before the scene is closed."""
        self._outdated = itertools.chain(self._outdated, emptyReplay(self.services.scene))

    def forgetScene(self) -> None:
        self._until = None

    def show(self, trial: StoredTrial, progress: Progress = no_progress) -> None:
        """Show a trial again from its beginning; if `progress` cancels, nothing is shown."""
        self._put(trial, progress)
        self._play(None)

    def showWorstTouch(self, trial: StoredTrial, progress: Progress = no_progress) -> None:
        """Show again how the worst touch came about; otherwise as `show`."""
        trialId = trial.record.trial_id
        if self._known[0] != trialId:
            judged = inBackground(lambda report: self._judge(trial, report), progress)
            self.takeFeedback(trialId, judged)
        feedback = self.feedback(trial)
        interval = None if feedback is None else feedback.worst.replay_s
        if interval is None:
            inBackground(partial(self._track, trialId), progress)
            raise InputError(_("The journal does not say when the worst touch was made."))
        self._put(trial, progress)
        goTo(self.services.scene, interval[0])
        self._play(interval[1])

    def process(self) -> None:
        """Stop where the worst touch was made; request feedback that no score has given."""
        # No work of the background waits for it: that starts only once nothing waits in turn.
        self.isReleasing = len(list(itertools.islice(self._outdated, SLICES_A_TURN))) > 0
        if self._awaitedId and not self.isBeingScored(self._awaitedId):
            self._awaitedId = ""
            self.feedbackFound.emit()
        now, browser = moment(self.services.scene), findReplay(self.services.scene)
        if self._until is not None and now and browser and now[0] >= self._until:
            browser.SetPlaybackActive(False)
            self._until = None

    def _judge(self, trial: StoredTrial, progress: Progress) -> TrialFeedback:
        services, record = self.services, trial.record
        scenario = services.findScenario(record.scenario)
        analysis = services.run(EXPLAIN, progress, record, scenario, services.records)
        with services.openStudy() as study:
            # A score keeps its version, however it would be computed today.
            scored = analysis.scored_as(trial.score, scenario, trial.truth)
            return with_progress(scored, study).feedback

    def _track(self, trialId: str, progress: Progress) -> ReplayTrack:
        return self.services.run(READ_TRACK, progress, self.services.records, trialId)

    def _put(self, trial: StoredTrial, progress: Progress) -> None:
        record, rigid = trial.record, trial.registrations.get(RIGID)
        services, scene = self.services, self.services.scene
        self._checkNoTrialIsOpen()
        if rigid is None:
            raise InputError(_("It is not known where the head was: the trial was not registered."))
        if (browser := findReplay(scene)) is not None:
            browser.SetPlaybackActive(False)
        isThere = isReplayOf(scene, record.trial_id)

        def read(report: Progress) -> tuple[Any, ...]:
            track = poses = None
            if not isThere:
                track = self._track(record.trial_id, report)
                poses = toolPoses(self.robot / URDF, track.q)
            scenario, outcome = services.findScenario(record.scenario), None
            if record.procedure is not None and trial.truth is not None:
                outcome = services.run(EXPLAIN_PROCEDURE, report, record, scenario, trial.truth)
            return track, poses, scenario, outcome

        track, poses, scenario, outcome = inBackground(read, progress)
        self._checkNoTrialIsOpen()
        if isThere and not isReplayOf(scene, record.trial_id):
            raise InputError(_("The scene was changed before the trial could be shown."))

        def inTurn(change: Callable[[], object]) -> None:
            change()
            progress(_("Showing"), 0.0)
            self._checkNoTrialIsOpen()

        showScenario(scene, scenario, inTurn)
        inTurn(lambda: showTask(scene, scenario, record.task, record.method))
        inTurn(lambda: showTouches(scene, record))
        self.shown.emit()
        self.procedureShown.emit(outcome, record.procedure, trial.truth)
        if track is None:
            goTo(scene, 0.0)
        else:
            # The steps that show the scenario run before the states go into the scene.
            progress(_("Showing"), 0.0)
            name, matrix = f"{record.trainee}, {record.task}", np.reshape(rigid.matrix, (4, 4))
            browser = showReplay(
                scene, name, track, poses, matrix, lambda share: progress(_("Showing"), share)
            )
            browser.SetAttribute(TRIAL_ATTRIBUTE, record.trial_id)
        # The replay shows them one by one, as they were made.
        setTouchesVisible(scene, False)

    def _checkNoTrialIsOpen(self) -> None:
        if self.isTrialOpen():
            raise InputError(_("A trial is in progress: replay another one when it is over."))

    def _play(self, until: float | None) -> None:
        self._until = until
        if (browser := findReplay(self.services.scene)) is not None:
            browser.SetPlaybackLooped(False)
            browser.SetPlaybackActive(True)
