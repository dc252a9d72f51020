"""What a trainee reads about the match of a trace before accepting it, computed in a thread."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from rastrainer.registration.fits import RIGID
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.given_points import GivenPoints
from rastrainer.trial.touch_registration import register_trial
from rastrainer_simulator.loop.precise_clock import raise_thread_priority
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.registered_trial import given


@dataclass(frozen=True)
class MatchReport:
    """A match as numbers, lengths in mm, and the codes of what looks wrong with it.

    Attributes:
        residual_mm: root mean square of the distances of the points that count from the skin.
        inlier_share: share of the points that count.
        expected_mm: expected TRE at the target.
        interval_mm: the 95 % interval of the TRE there.
        slide_mm: how far the head may be off where the trace determines it least.
        codes: as of `find_match_warnings`.
    """

    residual_mm: float
    inlier_share: float
    expected_mm: float
    interval_mm: tuple[float, float]
    slide_mm: float
    codes: tuple[str, ...] = ()


def look_at_match(training: TrainingState, scenario: Scenario) -> Future[MatchReport]:
    """Have the trace of an open trial matched as it will be when it is registered.

    The result raises an InputError where it cannot be.
    """
    # Set aside while it holds the interpreter, it would make the control loop wait.
    worker = ThreadPoolExecutor(1, "match", raise_thread_priority)
    looked = worker.submit(match_report, training, scenario)
    worker.shutdown(wait=False)
    return looked


def match_report(training: TrainingState, scenario: Scenario) -> MatchReport:
    """Return what is shown of the match of a trial's trace.

    Raises:
        InputError: the trace cannot be matched.
    """
    answer = {"task": training.task, "method": training.method.value, **given(training)}
    registered = register_trial(GivenPoints.of_answer(answer), scenario)
    match, error = registered.match, registered.target_errors[RIGID]
    assert match is not None, "the method has a trace"
    return MatchReport(
        match.rms_mm,
        match.inlier_share,
        error.expected_mm,
        error.interval_mm,
        match.slide.distance_mm,
        tuple(warning.code for warning in match.warnings),
    )
