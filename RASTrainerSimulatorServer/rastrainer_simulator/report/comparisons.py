"""The comparison of modes on the means of trainees who did both.

If the orders allow it, the effects of the modes are separated from the effect of their order.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.protocol import RegistrationMethod
from rastrainer.study.outcomes import Outcome
from rastrainer.study.study_data import StudyData
from rastrainer_simulator.statistics.paired import PairedComparison, compare_paired, holm_by_name

SCORE = "score"


def compared_method(data: StudyData) -> str:
    counts = Counter(trial.method for trial in data.trials)
    fiducials = RegistrationMethod.FIDUCIALS.value
    return fiducials if fiducials in counts or not counts else counts.most_common(1)[0][0]


CONFIRMATORY = ("completion_time_s", "rmse_mm", "score")
"""Corrected together for multiple testing; the others are only described."""
UNTESTED = {
    "ctps": "not tested: CTPS compares with the best trial of each mode, and chance in this one "
    "trial moves the mode's mean for all trainees alike"
}
"""A paired test finds a difference between equal modes in half of the studies of twelve."""


@dataclass(frozen=True)
class ModeComparison:
    """One outcome in two modes.

    Attributes:
        first: Mode that is subtracted from the second.
        order: By how many periods each trainee did the second mode later than the first, (n,)
            float; None if unknown.
        adjusted_p: p of the t-test, adjusted by Holm's method; None if only described.
    """

    outcome: Outcome
    first: str
    second: str
    trainees: tuple[str, ...]
    first_means: np.ndarray
    second_means: np.ndarray
    order: np.ndarray | None
    result: PairedComparison | None
    adjusted_p: float | None
    reason: str = ""


def compare_modes(
    data: StudyData,
    outcomes: Sequence[Outcome],
    first: str,
    second: str,
    confirmatory: Sequence[str] = CONFIRMATORY,
) -> tuple[ModeComparison, ...]:
    """Compare two modes on every outcome that trials of both have.

    A trainee's mean is over the tasks done in both modes, so a missing trial does not make a mode
    look easier. The effect of the period is removed if trainees had different orders of the modes.
    Only the `confirmatory` outcomes have an adjusted p.
    """
    found = []
    delays = mode_delays(data, first, second) if data.has_order else None
    for outcome in outcomes:
        means = paired_means(data, outcome.name, first, second)
        if not means:
            continue
        order = None if delays is None else np.array([delays[trainee] for trainee in means])
        one, other = np.array(list(means.values())).T
        result, reason = None, UNTESTED.get(outcome.name, "")
        if not reason:
            try:
                result = compare_paired(one, other, order)
            except InputError as error:
                reason = str(error)
        names = tuple(means)
        found.append(
            ModeComparison(outcome, first, second, names, one, other, order, result, None, reason)
        )
    return with_adjusted_p(found, confirmatory)


def with_adjusted_p(
    comparisons: Iterable[ModeComparison], confirmatory: Sequence[str]
) -> tuple[ModeComparison, ...]:
    found = list(comparisons)
    tested = {
        at: one.result.p
        for at, one in enumerate(found)
        if one.result is not None and one.outcome.name in confirmatory
    }
    adjusted = holm_by_name(tested)
    return tuple(replace(one, adjusted_p=adjusted.get(at)) for at, one in enumerate(found))


def paired_means(
    data: StudyData, name: str, first: str, second: str
) -> dict[str, tuple[float, float]]:
    values: dict[str, dict[str, dict[str, list[float]]]] = {name: {} for name in data.trainees}
    for trial in data.trials:
        if trial.mode in (first, second) and name in trial.values:
            of_task = values[trial.trainee].setdefault(trial.task, {})
            of_task.setdefault(trial.mode, []).append(trial.values[name])
    means = {}
    for trainee, of_tasks in values.items():
        both = [own for _task, own in sorted(of_tasks.items()) if len(own) == 2]
        if both:
            pairs = [[float(np.mean(own[mode])) for mode in (first, second)] for own in both]
            one, other = np.mean(pairs, axis=0).tolist()
            means[trainee] = one, other
    return means


def mode_delays(data: StudyData, first: str, second: str) -> dict[str, float]:
    """Return by how many periods each trainee did the second mode later than the first.

    A period is a run of trials in one mode: 1 if all of the first mode came before the second, -1
    for the opposite; for alternating modes, the difference of the mean periods.
    """
    periods: dict[str, dict[str, list[int]]] = {}
    latest: dict[str, tuple[str, int]] = {}
    for trial in data.trials:
        if trial.mode not in (first, second):
            continue
        mode, period = latest.get(trial.trainee, ("", 0))
        period += trial.mode != mode
        latest[trial.trainee] = trial.mode, period
        own = periods.setdefault(trial.trainee, {first: [], second: []})
        own[trial.mode].append(period)
    return {
        trainee: float(np.mean(own[second]) - np.mean(own[first]))
        for trainee, own in periods.items()
        if own[first] and own[second]
    }
