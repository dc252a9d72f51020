"""Tells what was good and bad in a trial, and shows it again, or its worst touch."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.arm_chain import read_arm_chain
from rastrainer.errors import InputError
from rastrainer.feedback.trial_feedback import TrialFeedback
from rastrainer.journal.replay_track import find_track
from rastrainer.registration import RIGID
from rastrainer.scenario import Scenario
from rastrainer.slicer.robot_scene import URDF
from rastrainer.slicer.scenario import showScenario, showTask
from rastrainer.slicer.trainee_desk import TraineeDesk
from rastrainer.slicer.translation import _
from rastrainer.slicer.trial_replay import findReplay, goTo, moment, showReplay
from rastrainer.study import StoredTrial
from rastrainer.trial_review import review, with_progress


class ReplayDesk:
    """Feedback on stored trials, and their replay, for which the journals must be here."""

    def __init__(
        self,
        scene: Any,
        trainees: TraineeDesk,
        findScenario: Callable[[str], Scenario],
        records: Path,
        robot: Path,
    ) -> None:
        """`records` is the folder of journals, `robot` that of the URDF."""
        self._scene = scene
        self._trainees = trainees
        self._findScenario = findScenario
        self._records = records
        self._robot = robot
        self._told: tuple[str, TrialFeedback] | None = None
        self._until: float | None = None

    def feedback(self, trial: StoredTrial) -> TrialFeedback:
        """Return what there is to say about a trial.

        Raises:
            InputError: its scenario is not here, or it cannot be registered.
        """
        record, study = trial.record, self._trainees.study
        if self._told is None or self._told[0] != record.trial_id:
            analysis = review(record, self._findScenario(record.scenario), study, self._records)
            self._told = record.trial_id, with_progress(analysis, study).feedback
        return self._told[1]

    def show(self, trial: StoredTrial) -> None:
        """Show a trial again, from its beginning.

        Raises:
            InputError: its journal or its scenario is not here, or it was not registered.
        """
        self._put(trial)
        self._play(None)

    def showWorstTouch(self, trial: StoredTrial) -> None:
        """Show again how the worst touch came about.

        Raises:
            InputError: as `show`.
        """
        interval = self.feedback(trial).worst.replay_s
        if interval is None:
            find_track(self._records, trial.record.trial_id)
            raise InputError(_("The journal does not tell when the worst touch was made."))
        self._put(trial)
        goTo(self._scene, interval[0])
        self._play(interval[1])

    @property
    def sentence(self) -> str:
        """Where the replay stands; empty where there is none."""
        now = moment(self._scene)
        if now is None:
            return ""
        return _("{time:.1f} s, clearance {clearance}").format(time=now[0], clearance=now[1])

    def process(self) -> None:
        """Stop where the worst touch was made."""
        now, browser = moment(self._scene), findReplay(self._scene)
        if self._until is not None and now is not None and now[0] >= self._until:
            browser.SetPlaybackActive(False)
            self._until = None

    def _put(self, trial: StoredTrial) -> None:
        record, rigid = trial.record, trial.registrations.get(RIGID)
        if rigid is None:
            raise InputError(_("Nothing tells where the head was: the trial was not registered."))
        track = find_track(self._records, record.trial_id)
        scenario = self._findScenario(record.scenario)
        showScenario(self._scene, scenario)
        showTask(self._scene, scenario, record.task)
        name, matrix = f"{record.trainee}, {record.task}", np.reshape(rigid.matrix, (4, 4))
        showReplay(self._scene, name, track, read_arm_chain(self._robot / URDF), matrix)

    def _play(self, until: float | None) -> None:
        self._until = until
        browser = findReplay(self._scene)
        browser.SetPlaybackLooped(False)
        browser.SetPlaybackActive(True)
