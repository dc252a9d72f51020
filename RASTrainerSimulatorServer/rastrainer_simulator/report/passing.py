"""Started, aborted and passed trials, and which trainees are competent by LC-CUSUM."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup

from rastrainer.protocol import TRIAL_RUN, RegistrationMethod
from rastrainer.registration.distributions import Proportion, proportion
from rastrainer.study.database.values import moment
from rastrainer.study.outcomes import mode_title, short_mode_title, task_title
from rastrainer.study.protocol.study_protocol import pass_mark_of
from rastrainer.study.study_data import StudyData
from rastrainer.trial import lc_cusum, scoring, trial_feedback
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.comparisons import SCORE, compared_method
from rastrainer_simulator.report.page import render

MAX_NAMED_TRIALS = 5


def started_trials(data: StudyData) -> Markup:
    """Return the section; "" if only finished trials are known, as in a CSV file."""
    if not data.has_order:
        return Markup()
    scored = [record for record in data.aborted if record.task != TRIAL_RUN]
    finished = Counter((trial.trainee, trial.mode, trial.task) for trial in data.trials)
    early: Counter[tuple[str, str, str]] = Counter()
    late: Counter[tuple[str, str, str]] = Counter()
    for record in scored:
        counter = late if record.is_after_all_touches else early
        counter[record.trainee, record.mode, record.task] += 1
    counts = [
        ((key[0], mode_title(key[1]), task_title(key[2])), (finished[key], early[key], late[key]))
        for key in sorted({*early, *late})
    ]
    whole = (len(data.trials), early.total(), late.total())
    counts.append((("all trials of the study", "", ""), whole))
    return render(
        "started_trials",
        data=data,
        scored=scored,
        trial_runs=len(data.aborted) - len(scored),
        rows=[[*names, sum(numbers), *numbers] for names, numbers in counts],
        unscored=sorted(trial.trial_id for trial in data.trials if SCORE not in trial.values),
        most_named=MAX_NAMED_TRIALS,
        repeats=[record for record in scored if record.repeat_reason],
    )


@dataclass(frozen=True)
class ModePassing:
    """The trials of a mode that passed, of all that count, with trials aborted after a touch.

    `competent` has the number of the trial that showed a trainee's competence.
    """

    mode: str
    passed: Proportion
    competence: dict[str, lc_cusum.LcCusum]
    competent: dict[str, int]
    aborted: int
    unscored: int


def passing_of(data: StudyData) -> list[ModePassing]:
    """Return who has passed in each mode; nothing without a score, or a mark for its method."""
    mark = pass_mark_of(data.protocol, compared_method(data))
    if mark is None or not any(SCORE in trial.values for trial in data.trials):
        return []
    found = []
    for mode in data.modes:
        failures, aborted = _failures(data, mode, mark)
        trials = [failed for own in failures.values() for failed in own]
        if trials:
            passed = proportion(len(trials) - sum(trials), len(trials))
            charts_ = {who: trial_feedback.competence_of(own) for who, own in failures.items()}
            competent = {
                who: at for who, c in charts_.items() if (at := c.competent_at) is not None
            }
            unscored = sum(SCORE not in trial.values for trial in data.of_mode(mode))
            found.append(ModePassing(mode, passed, charts_, competent, aborted, unscored))
    return found


def passing(data: StudyData, found: list[ModePassing]) -> Markup:
    """Return the section; "" where no trial has a score."""
    if not any(SCORE in trial.values for trial in data.trials):
        return Markup()
    mark, method = pass_mark_of(data.protocol, compared_method(data)), compared_method(data)
    trials = trial_feedback.TRAINING_TRIALS
    rates = trial_feedback.ADEQUATE_FAILURES, trial_feedback.INADEQUATE_FAILURES
    success, _failure = lc_cusum.log_likelihood_ratios(*rates)
    # Successes only; rounding errors do not ask for one more.
    fewest = int(np.ceil(lc_cusum.lc_cusum_limit(*rates, trials) / success - 1e-12))
    by_chance = lc_cusum.signal_probability(rates[1], trials, *rates, (fewest - 1) * success)
    protocol = data.protocol
    return render(
        "passing",
        mark=mark,
        protocol=protocol,
        is_own_mark=protocol is not None and protocol.pass_mark is not None,
        method=method,
        has_bias_limit=method == RegistrationMethod.FIDUCIALS,
        limits=scoring,
        found=found,
        median=lambda numbers: f"{np.median(list(numbers)):g}",
        charts=[_chart(data, one) for one in found],
        rates=rates,
        trials=trials,
        fewest=fewest,
        by_chance=by_chance,
        false_discovery=lc_cusum.FALSE_DISCOVERY,
    )


def _failures(data: StudyData, mode: str, mark: float) -> tuple[dict[str, list[bool]], int]:
    """Return whether each trial of each trainee failed, in order of starting.

    A trial without a score failed, and an aborted trial if it counts; the number of such aborted
    trials is returned, too.
    """
    aborted = [
        TrialRow.of(record)
        for record in data.aborted
        if record.mode == mode and record.counts_as_failed
    ]
    finished = data.of_mode(mode)
    failures: dict[str, list[bool]] = {trial.trainee: [] for trial in [*finished, *aborted]}
    for trial in sorted([*aborted, *finished], key=lambda trial: moment(trial.started_utc)):
        failures[trial.trainee].append(not scoring.passes(trial.score, trial.acceptable, mark))
    return failures, len(aborted)


def _chart(data: StudyData, found: ModePassing) -> Markup:
    points = {
        trainee: [(float(number), score) for number, score in enumerate(chart.scores, start=1)]
        for trainee, chart in found.competence.items()
    }
    # All have the same limit.
    limit = next(iter(found.competence.values())).limit
    last = max(len(chart.scores) for chart in found.competence.values())
    return charts.learning_curves(
        f"{short_mode_title(found.mode)}: LC-CUSUM",
        charts.mode_color(found.mode, data.modes.index(found.mode)),
        points,
        "trial",
        [(1.0, limit), (float(last), limit)],
        (0.0, limit),
    )
