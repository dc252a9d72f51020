"""The simulator's own score of a trial that ends where no Slicer is connected.

It is computed as Slicer computes it and submitted as Slicer submits it: the registration first,
which makes it final; then the truth is known; then the score. Whoever registers the trial later
finds the same registration, or is refused.
"""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import TRIAL_RUN, CommandName, Phase, check_arguments
from rastrainer.scenario.scenario import Scenario
from rastrainer.study.trial_review import scored_with_journal, with_progress_among
from rastrainer.trial.analysis import RevealedTruth, TrialAnalysis, analyze_trial
from rastrainer.trial.ctps import PUBLISHED_STUDY, read_trials
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import PASS_MARK
from rastrainer.trial.submission import registration_arguments, score_arguments
from rastrainer.trial.trainee_progress import PastTrial
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.flow.session.commands import Submit
from rastrainer_simulator.state import TrainingState

SENDER = "simulator"
OWN_SCORE = "isOwnScore"
"""The entry of a score's details that says whose it is."""
RETURN_S = 5.0
"""A Slicer whose connection was lost is back after less, unless it has ended."""
ANSWER_S = 60.0
_REST_S = 0.001

Ask = Callable[[str, Mapping[str, Any]], Mapping[str, Any]]

_log = logging.getLogger(__name__)


class OwnScore:
    """Watches for a registered trial that nobody scores, and scores it in a thread.

    Attributes:
        problem: why the present trial cannot be scored, a sentence; empty otherwise.
    """

    def __init__(
        self,
        submit: Submit,
        records: Path,
        is_slicer_connected: Callable[[], bool],
        attempts_of: Callable[[str], Sequence[PastTrial]],
    ) -> None:
        """Prepare.

        Args:
            submit: has the simulation carry out a command.
            records: folder of the trials' journals.
            is_slicer_connected: says whether a client is connected; asked in the thread, too.
            attempts_of: gives a trainee's earlier scored trials and failures, oldest first.
        """
        self.problem = ""
        self._submit = submit
        self._records = records
        self._is_slicer_connected = is_slicer_connected
        self._attempts_of = attempts_of
        self._had_slicer = False
        self._alone_s = 0.0
        self._begun = ""
        self._thread: threading.Thread | None = None

    def advance(
        self, dt: float, training: TrainingState, scenario: Scenario, is_in_study: bool
    ) -> None:
        """Begin to score the trial once it is registered and no Slicer is there, or comes back."""
        if self._is_slicer_connected() or training.phase is not Phase.REGISTERED:
            self._had_slicer = self._had_slicer or self._is_slicer_connected()
            self._alone_s, self._begun, self.problem = 0.0, "", ""
            return
        self._alone_s += dt
        is_busy = self._thread is not None and self._thread.is_alive()
        may_return = self._had_slicer and self._alone_s < RETURN_S
        if is_in_study or is_busy or may_return or self._begun == training.trial_id:
            return
        self._begun = training.trial_id
        earlier = [t for t in self._attempts_of(training.trainee) if t.trial_id != self._begun]
        self._thread = threading.Thread(
            target=self._score, args=(self._begun, scenario, earlier), name="score", daemon=True
        )
        self._thread.start()

    def _score(self, trial_id: str, scenario: Scenario, earlier: Sequence[PastTrial]) -> None:
        try:
            analysis = registered_alone(self._ask, trial_id, scenario)
            if not self._is_slicer_connected():
                score_alone(self._ask, analysis, scenario, earlier, self._records)
        except InputError as error:
            _log.warning("The trial %s was not scored: %s", trial_id, error)
            if self._begun == trial_id:
                self.problem = str(error)

    def _ask(self, command: str, arguments: Mapping[str, Any]) -> Mapping[str, Any]:
        answer = self._submit(command, arguments, SENDER).result(ANSWER_S)
        if not answer.ok:
            raise InputError(answer.message)
        return answer.data


def registered_alone(ask: Ask, trial_id: str, scenario: Scenario) -> TrialAnalysis:
    """Return the registration of a trial; it is not submitted yet.

    Raises:
        InputError: there is no such trial, or it cannot be registered.
    """
    told = ask(CommandName.GET_TRIAL, {"trialId": trial_id})
    cohort = read_trials(asset_path(*PUBLISHED_STUDY))
    return analyze_trial(TrialRecord.from_json(told["record"]), scenario, cohort, pause=_rest)


def score_alone(
    ask: Ask,
    analysis: TrialAnalysis,
    scenario: Scenario,
    earlier: Sequence[PastTrial],
    records: Path,
) -> None:
    """Submit a registration, which makes it final, and the score that its truth gives.

    Args:
        ask: has a command carried out, and returns the data of its answer.
        analysis: the registration.
        scenario: in which the trial was played.
        earlier: the trainee's earlier scored trials and failures, oldest first.
        records: folder of the trials' journals.

    Raises:
        InputError: another registration was submitted before, or the trial cannot be scored.
    """
    truth = RevealedTruth.from_json(
        _asked(ask, CommandName.SUBMIT_REGISTRATION, registration_arguments(analysis))
    )
    scored = scored_with_journal(analysis, truth, scenario, records=records, pause=_rest)
    arguments = score_arguments(_with_progress(scored, earlier))
    arguments["details"][OWN_SCORE] = True
    _asked(ask, CommandName.TRIAL_SCORED, arguments)


def _asked(ask: Ask, command: str, arguments: Mapping[str, Any]) -> Mapping[str, Any]:
    """Have a command carried out after the checks that a client's has to pass."""
    return ask(command, check_arguments(command, arguments))


def _with_progress(analysis: TrialAnalysis, earlier: Sequence[PastTrial]) -> TrialAnalysis:
    """Return the analysis of a scored trial with its place after the trainee's earlier ones."""
    record, score = analysis.record, analysis.score
    if score is None or record.task == TRIAL_RUN:
        return analysis
    this = PastTrial(
        record.trial_id,
        record.task,
        record.mode,
        record.completion_time_s,
        score.score,
        score.acceptable,
        score_version=score.version,
    )
    return with_progress_among(analysis, (*earlier, this), PASS_MARK)


def _rest() -> None:
    time.sleep(_REST_S)
