"""Started, aborted and passed trials, and which trainees are competent by LC-CUSUM."""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass
from datetime import datetime

import numpy as np
from markupsafe import Markup

from rastrainer.protocol import TRIAL_RUN, RegistrationMethod
from rastrainer.study.database.values import moment
from rastrainer.study.outcomes import mode_title, short_mode_title, task_title
from rastrainer.study.protocol.study_protocol import pass_mark_of
from rastrainer.study.study_data import StudyData
from rastrainer.study.tre_calibration import Proportion, proportion
from rastrainer.trial import lc_cusum, scoring, trial_feedback
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.comparisons import SCORE, compared_method
from rastrainer_simulator.report.page import render

MAX_NAMED_TRIALS = 5


def started_trials(data: StudyData) -> Markup:
    """Return the section; "" if only finished trials are known, as in a CSV file."""
    if not data.has_order:
        return Markup()
    scored = [stored for stored in data.aborted if stored.record.task != TRIAL_RUN]
    finished = Counter((trial.trainee, trial.mode, trial.task) for trial in data.trials)
    early: Counter[tuple[str, str, str]] = Counter()
    late: Counter[tuple[str, str, str]] = Counter()
    for stored in scored:
        record = stored.record
        counter = late if record.is_after_all_touches else early
        counter[record.trainee, record.mode, record.task] += 1
    counts = [
        (
            (key[0], mode_title(key[1]), task_title(key[2])),
            (finished[key], early[key], late[key]),
        )
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
        repeats=[stored for stored in scored if stored.repeat_reason],
    )


@dataclass(frozen=True)
class ModePassing:
    """The trials of a mode that passed, of all that count, with trials aborted after a touch.

    Attributes:
        competent: Number of the trial that showed a trainee's competence.
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
    """Return whether each trial of each trainee failed, in order; one without a score did.

    Aborted trials that count as not passed are included in order of time; their number is
    returned, too.
    """
    records = [stored.record for stored in data.aborted]
    aborted: dict[str, list[datetime]] = defaultdict(list)
    for record in records:
        if record.mode == mode and record.counts_as_failed:
            aborted[record.trainee].append(moment(record.started_utc))
    count = sum(map(len, aborted.values()))
    failures: dict[str, list[bool]] = defaultdict(list)
    for trial in sorted(data.of_mode(mode), key=lambda trial: trial.number):
        own = aborted[trial.trainee]
        while own and own[0] <= moment(trial.started_utc):
            own.pop(0)
            failures[trial.trainee].append(True)
        score = trial.values.get(SCORE)
        has_passed = score is not None and scoring.passes(score, trial.acceptable, mark)
        failures[trial.trainee].append(not has_passed)
    for trainee, own in aborted.items():
        if own:
            failures[trainee] += [True] * len(own)
    return failures, count


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
