"""The simulator's own registration and score of a trial where no Slicer is connected.

It is computed as Slicer computes it and submitted as Slicer submits it: the registration first,
which makes it final; then the truth is known; then the score. A client that registers the
trial later finds the same registration, or is refused.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from functools import partial
from pathlib import Path
from typing import Any

from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json
from rastrainer.protocol import TRIAL_RUN, Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.analysis import (
    RevealedTruth,
    TrialAnalysis,
    analyze_trial,
    score_arguments,
)
from rastrainer.trial.ctps import PUBLISHED_STUDY, read_trials
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import PASS_MARK
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.state import Answer, TrainingState

SENDER = "simulator"
SCORED_BY_SIMULATOR = "scoredBySimulator"
"""The entry of a score's details that names its source."""
RETURN_S = 5.0
"""A Slicer whose connection was lost is back after less, unless it has ended."""
ANSWER_S = 60.0

Submit = Callable[[str, Mapping[str, Any], str], "Future[Answer]"]
Ask = Callable[[str, Mapping[str, Any]], Mapping[str, Any]]

_rest = partial(time.sleep, 0.001)
_log = logging.getLogger(__name__)


Job = tuple[str, Phase, int]
"""Work done without Slicer: scoring a trial, or registering its n-th attempt."""


class LocalScorer:
    """Watches for a trial that no Slicer registers or scores, and does it in a thread.

    `problem` is the sentence about why that is not possible; empty otherwise.
    """

    def __init__(
        self,
        submit: Submit,
        records: Path,
        is_slicer_connected: Callable[[], bool],
        attempts_of: Callable[[str], Sequence[TrialRow]],
    ) -> None:
        """`attempts_of` gives a trainee's scored trials and failures, oldest first.

        `is_slicer_connected` is asked in the thread, too.
        """
        self.problem = ""
        self._submit = submit
        self._records = records
        self._is_slicer_connected = is_slicer_connected
        self._attempts_of = attempts_of
        self._had_slicer = False
        self._alone_s = 0.0
        self._begun: Job | None = None
        self._thread: threading.Thread | None = None

    def advance(
        self, dt: float, training: TrainingState, scenario: Scenario, is_in_study: bool
    ) -> None:
        """Start what no Slicer does, if none has been connected for some time.

        A trial that is registered is scored, outside of a study. The touches of one with a
        procedure are registered so that it can continue: that reveals nothing.
        """
        job: Job | None = None
        procedure, phase = training.procedure, training.phase
        if phase is Phase.REGISTERED and not is_in_study:
            job = training.trial_id, phase, 0
        elif phase is Phase.VERIFYING and procedure and procedure.registration is None:
            job = training.trial_id, phase, len(procedure.attempts)
        if self._is_slicer_connected() or job is None:
            self._had_slicer = self._had_slicer or self._is_slicer_connected()
            self._alone_s, self._begun, self.problem = 0.0, None, ""
            return
        self._alone_s += dt
        is_busy = self._thread is not None and self._thread.is_alive()
        may_return = self._had_slicer and self._alone_s < RETURN_S
        if is_busy or may_return or self._begun == job:
            return
        self._begun = job
        earlier = [t for t in self._attempts_of(training.trainee) if t.trial_id != job[0]]
        self._thread = threading.Thread(
            target=self._do, args=(job, scenario, earlier), name="score", daemon=True
        )
        self._thread.start()

    def _do(self, job: Job, scenario: Scenario, earlier: Sequence[TrialRow]) -> None:
        trial_id, phase, _attempt = job
        try:
            if phase is Phase.VERIFYING:
                # The procedure continues with that.
                answer = self._ask(CommandName.GET_TRIAL, {"trialId": trial_id})
                registered = register_trial(GivenPoints.of_answer(answer), scenario, pause=_rest)
                self._ask(CommandName.USE_REGISTRATION, registered.arguments(trial_id))
                return
            analysis = registered_alone(self._ask, trial_id, scenario)
            if not self._is_slicer_connected():
                score_alone(self._ask, analysis, scenario, earlier, self._records)
        except InputError as error:
            done = "scored" if phase is Phase.REGISTERED else "registered"
            _log.warning("The trial %s was not %s: %s", trial_id, done, error)
            if self._begun == job:
                self.problem = str(error)

    def _ask(self, command: str, arguments: Mapping[str, Any]) -> Mapping[str, Any]:
        checked = check_arguments(command, arguments)
        answer = self._submit(command, checked, SENDER).result(ANSWER_S)
        if not answer.ok:
            raise InputError(answer.message)
        return answer.data


def registered_alone(ask: Ask, trial_id: str, scenario: Scenario) -> TrialAnalysis:
    """Return the registration of a trial; it is not submitted yet."""
    record = record_from_json(
        TrialRecord, ask(CommandName.GET_TRIAL, {"trialId": trial_id})["record"]
    )
    if record.scenario != scenario.name:
        # Another head may have been loaded since the trial was finished.
        raise InputError(
            f"The trial was played in the scenario {record.scenario}, but {scenario.name} is "
            "loaded; 3D Slicer scores the trial when it connects."
        )
    cohort = read_trials(asset_path(*PUBLISHED_STUDY))
    return analyze_trial(record, scenario, cohort, pause=_rest)


def score_alone(
    ask: Ask,
    analysis: TrialAnalysis,
    scenario: Scenario,
    earlier: Sequence[TrialRow],
    records: Path,
) -> None:
    """Submit a registration, which makes it final, and the score that its truth gives."""
    # Here, since few starts of the simulator need what stores trials in a study.
    from rastrainer.study.delivered_trial import scored_with_journal, with_progress_among

    answer = ask(CommandName.SUBMIT_REGISTRATION, analysis.arguments(analysis.record.trial_id))
    truth = record_from_json(RevealedTruth, answer, "The simulator's answer")
    scored = scored_with_journal(analysis, truth, scenario, records=records, pause=_rest)
    record, score = scored.record, scored.score
    if score is not None and record.task != TRIAL_RUN:
        values = {"score": score.score}
        this = TrialRow.of(record, values=values, acceptable=score.acceptable)
        scored = with_progress_among(scored, (*earlier, this), PASS_MARK)
    arguments = score_arguments(scored)
    arguments["details"][SCORED_BY_SIMULATOR] = True
    ask(CommandName.TRIAL_SCORED, arguments)
