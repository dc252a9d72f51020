"""Started, aborted and passed trials, and which trainees are competent by LC-CUSUM."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable
from datetime import datetime

import numpy as np

from rastrainer.number_text import counted, percent
from rastrainer.protocol import RegistrationMethod
from rastrainer.report import page, svg
from rastrainer.report.comparisons import SCORE, compared_method
from rastrainer.report.learning import learning_curves
from rastrainer.statistics.competence import (
    FALSE_DISCOVERY,
    LcCusum,
    chance_of_successes,
    fewest_trials,
    lc_cusum_limit,
)
from rastrainer.study.database.values import StoredAbortedTrial, moment
from rastrainer.study.outcomes import mode_title, short_mode_title, task_title
from rastrainer.study.protocol.study_protocol import pass_mark_of
from rastrainer.study.study_data import StudyData, TrialRow
from rastrainer.trial import scoring, trial_feedback
from rastrainer.trial.aborted_trial import AbortedTrial

STARTED_HEADER = [
    *("trainee", "mode", "task", "started (n)", "finished"),
    *("aborted before all touches", "aborted after all touches"),
]


def started_trials(data: StudyData) -> str:
    """Return the section; "" if only finished trials are known, as in a CSV file."""
    if not data.has_order:
        return ""
    scored = [stored for stored in data.aborted if not stored.record.is_trial_run]
    runs = len(data.aborted) - len(scored)
    total = len(data.trials) + len(scored)
    parts = [page.paragraph(f"{len(data.trials)} of {total} started trials were finished.")]
    if scored:
        parts.append(page.table([STARTED_HEADER], _started_rows(data, scored)))
        failed = sum(stored.record.counts_as_failed for stored in scored)
        parts.append(
            page.note(
                "Tasks of trainees who aborted none are left out of the table. An aborted trial "
                f"with a touch ({failed} of {len(scored)}) counts as not passed in the pass mark's "
                "LC-CUSUM; it has no score and no time for anything else here, so that what "
                "follows is about the finished trials."
            )
        )
    if runs:
        parts.append(
            page.paragraph(
                f"{counted(runs, 'trial run')} {'was' if runs == 1 else 'were'} ended without "
                "being registered, as is usual; none counts."
            )
        )
    parts += [page.warning(sentence) for sentence in _missing(data)]
    repeats = [
        f"{stored.record.trainee}, {stored.step}, aborted with {len(stored.record.points)} points "
        f"touched ({stored.record.reason}): {stored.repeat_reason}"
        for stored in scored
        if stored.repeat_reason
    ]
    if repeats:
        parts += [page.heading("Steps of the protocol that were repeated"), page.bullets(repeats)]
    silent = sum(not stored.repeat_reason for stored in scored)
    if data.protocol is not None and silent:
        parts.append(
            page.note(
                f"For {counted(silent, 'aborted trial')} no reason of a repeat is stored: the "
                "step was not repeated, was skipped, or its repeat had arrived before."
            )
        )
    return page.section("Started trials", *parts)


def _missing(data: StudyData) -> list[str]:
    """Return sentences about trials without a score and trials that never arrived."""
    unscored = _unscored(data.trials)
    sentences = []
    if unscored:
        sentences.append(
            f"{counted(len(unscored), 'finished trial')} without a score: each counts as not "
            "passed, and comparisons of scores leave it out "
            f"({', '.join(sorted(trial.trial_id for trial in unscored))})."
        )
    for series, gaps in data.undelivered.items():
        count = sum(last - first + 1 for first, last in gaps)
        numbers = ", ".join(f"{a}" if a == b else f"{a} to {b}" for a, b in gaps)
        sentences.append(
            f"{counted(count, 'started trial')} of the simulator {series[:8]} never arrived in "
            f"this study, by the number in the journal's first line: {numbers}. Each went to "
            "another study, still waits at the simulator, or was made to vanish."
        )
    return sentences


def _unscored(trials: Iterable[TrialRow]) -> list[TrialRow]:
    return [trial for trial in trials if SCORE not in trial.values]


def _started_rows(data: StudyData, aborted: list[StoredAbortedTrial]) -> list[list[str]]:
    finished = Counter((trial.trainee, trial.mode, trial.task) for trial in data.trials)
    early: Counter[tuple[str, str, str]] = Counter()
    late: Counter[tuple[str, str, str]] = Counter()
    for stored in aborted:
        record = stored.record
        counter = late if record.is_after_all_touches else early
        counter[record.trainee, record.mode, record.task] += 1
    keys = sorted({*early, *late})
    rows = [
        [who, mode_title(mode), task_title(task), *_counts(finished[key], early[key], late[key])]
        for key in keys
        for who, mode, task in [key]
    ]
    whole = _counts(len(data.trials), sum(early.values()), sum(late.values()))
    return [*rows, ["all trials of the study", "", "", *whole]]


def _counts(finished: int, early: int, late: int) -> list[str]:
    return [str(finished + early + late), str(finished), str(early), str(late)]


HEADER = [
    *("mode", "trials", "passed", "trainees competent", "shown at trial (median)"),
    *("aborted trials among them", "without a score among them"),
]


def passing(data: StudyData) -> str:
    """Return the section; "" where no trial has a score."""
    if not any(SCORE in trial.values for trial in data.trials):
        return ""
    mark = pass_mark_of(data.protocol, compared_method(data))
    if mark is None:
        return page.section("Pass mark", page.warning(_no_mark(data)))
    found = {mode: _failures(data, mode, mark) for mode in data.modes}
    found = {mode: failures for mode, failures in found.items() if failures}
    competence = {
        mode: {trainee: trial_feedback.competence_of(own) for trainee, own in failures.items()}
        for mode, failures in found.items()
    }
    return page.section(
        "Pass mark",
        page.table(
            [HEADER], [_row(data, mode, found[mode], competence[mode]) for mode in found], "wide"
        ),
        page.figure(
            [_chart(data, mode, charts) for mode, charts in competence.items()],
            "LC-CUSUM of every trainee; thick: the limit at which competence is shown.",
        ),
        page.note(_words(data, mark)),
    )


def _failures(data: StudyData, mode: str, mark: float) -> dict[str, list[bool]]:
    """Return whether each trial of each trainee failed, in order; one without a score did.

    Aborted trials that count as not passed are included in order of time.
    """
    aborted: dict[str, list[datetime]] = defaultdict(list)
    for record in _aborted(data, mode):
        aborted[record.trainee].append(moment(record.started_utc))
    failures: dict[str, list[bool]] = defaultdict(list)
    for trial in sorted(data.of_mode(mode), key=lambda trial: trial.number):
        own = aborted[trial.trainee]
        while own and own[0] <= moment(trial.started_utc):
            own.pop(0)
            failures[trial.trainee].append(True)
        score = trial.values.get(SCORE)
        passed = score is not None and scoring.passes(score, trial.acceptable, mark)
        failures[trial.trainee].append(not passed)
    for trainee, own in aborted.items():
        if own:
            failures[trainee] += [True] * len(own)
    return failures


def _aborted(data: StudyData, mode: str) -> list[AbortedTrial]:
    records = [stored.record for stored in data.aborted]
    return [record for record in records if record.mode == mode and record.counts_as_failed]


def _row(
    data: StudyData, mode: str, failures: dict[str, list[bool]], charts: dict[str, LcCusum]
) -> list[str]:
    trials = [failed for own in failures.values() for failed in own]
    shown_at = [chart.competent_at for chart in charts.values()]
    competent = [number for number in shown_at if number is not None]
    passed = len(trials) - sum(trials)
    return [
        mode_title(mode),
        str(len(trials)),
        f"{passed} ({percent(passed / len(trials))})",
        f"{len(competent)} of {len(failures)}",
        f"{np.median(competent):g}" if competent else "–",
        str(len(_aborted(data, mode))),
        str(len(_unscored(data.of_mode(mode)))),
    ]


def _chart(data: StudyData, mode: str, charts: dict[str, LcCusum]) -> str:
    points = {
        trainee: [(float(number), score) for number, score in enumerate(chart.scores, start=1)]
        for trainee, chart in charts.items()
    }
    # All have the same limit.
    limit = next(iter(charts.values())).limit
    last = max(len(chart.scores) for chart in charts.values())
    return learning_curves(
        f"{short_mode_title(mode)}: LC-CUSUM",
        svg.mode_color(mode, data.modes.index(mode)),
        points,
        "trial",
        [(1.0, limit), (float(last), limit)],
        (0.0, limit),
    )


def _words(data: StudyData, mark: float) -> str:
    source = "the default, since the study sets no mark; no data support it"
    if data.protocol is not None and data.protocol.pass_mark is not None:
        source = "set by the protocol"
    trials = trial_feedback.TRAINING_TRIALS
    rates = trial_feedback.ADEQUATE_FAILURES, trial_feedback.INADEQUATE_FAILURES
    fewest = fewest_trials(*rates, lc_cusum_limit(*rates, trials))
    too_likely = chance_of_successes(fewest - 1, trials, *rates)
    adequate, inadequate = map(percent, rates)
    return (
        f"A trial passes with {mark:g} of 100 points ({source}) and "
        f"{_acceptable(compared_method(data))}; one that was aborted after a touch, or has no "
        "score, is not passed. LC-CUSUM (Biau and Porcher 2010) calls a trainee competent once "
        "the trials of a mode, over all tasks, speak clearly enough for a failure rate of "
        f"{adequate} against one of {inadequate}. Fewer than {fewest} trials in a mode cannot show "
        f"it, even if all are passed: the score of {fewest - 1} passed trials would be reached by "
        f"chance, within {trials} trials, by {100 * too_likely:.1f} % of those who fail in "
        f"{inadequate}, and at most {percent(FALSE_DISCOVERY)} of them may be called competent. "
        "This takes trials as independent: of trainees who fail as often, but on good days and "
        "bad ones, several times as many are called competent."
    )


def _acceptable(method: str) -> str:
    is_by_fiducials = method == RegistrationMethod.FIDUCIALS
    bias = f"a bias common to all touches of at most {scoring.COMMON_BIAS_LIMIT_MM:g} mm, "
    return (
        "within the limits of the score: a true target error in the brain within that of its "
        f"task, {bias if is_by_fiducials else ''}unintended contact of at most "
        f"{scoring.CONTACT_LIMIT_S:g} s and {scoring.CONTACT_PATH_LIMIT_MM:g} mm, and a pressing "
        f"depth of at most {scoring.DEPTH_LIMIT_MM:g} mm"
    )


def _no_mark(data: StudyData) -> str:
    assert data.protocol is not None
    return (
        f"The protocol's pass mark of {data.protocol.pass_mark:g} points is for trials registered "
        f"by fiducials, and these were registered by {compared_method(data)}. Their scores do not "
        "compare, so that this report does not say which trials passed or who is competent."
    )
