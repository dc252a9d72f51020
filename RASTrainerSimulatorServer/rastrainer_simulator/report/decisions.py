"""Drills of decisions: their cost, missed causes, confidence, learning, and training."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from markupsafe import Markup

from rastrainer.decision import drill_score
from rastrainer.decision.drill_record import DecidedCase, Decision, Fault
from rastrainer.decision.drill_rows import drill_rows
from rastrainer.protocol import DECIDE
from rastrainer.registration.distributions import Proportion, proportion
from rastrainer.study.database.values import moment
from rastrainer.study.outcomes import Outcome
from rastrainer.study.study_data import StudyData
from rastrainer.study.tre_calibration import MIN_SHARE_TRIALS
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.comparisons import ModeComparison, compare_modes
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.intervals import Estimate, detectable_effect, mean
from rastrainer_simulator.statistics.trend import CohortTrend, TrendVerdict, cohort_trends

SENSITIVITY = Outcome("sensitivity", "Sensitivity d′", better=1)
COST = Outcome("mean_cost", "Cost of a case", better=-1)
TESTED = (SENSITIVITY, COST)
BEFORE, AFTER = "before training", "after training"
Group = TypeVar("Group")
COLOR = charts.OTHER_COLORS[0]


@dataclass(frozen=True)
class Decisions:
    """Results of the drills of a study: `rows` and `cases` by trainee, in order of time.

    `missed` are of the cases over the limit those with `proceed`, by fault, the largest share
    first; `trained` compares drills before and after training.
    """

    rows: dict[str, list[TrialRow]]
    cases: dict[str, list[DecidedCase]]
    missed: dict[Fault, Proportion]
    trends: dict[Outcome, CohortTrend | None]
    abandoned: int
    trained: tuple[ModeComparison, ...]

    @property
    def passed(self) -> Proportion:
        """How many trainees passed their latest drill."""
        return proportion(sum(own[-1].acceptable for own in self.rows.values()), len(self.rows))

    @property
    def missed_most(self) -> tuple[Fault, Proportion] | None:
        often = (each for each in self.missed.items() if each[1].total >= MIN_SHARE_TRIALS)
        return next((each for each in often if each[1].count), None)


def decisions_of(data: StudyData) -> Decisions | None:
    """Return what the drills show; None without drills."""
    if not data.drills:
        return None
    rows: dict[str, list[TrialRow]] = defaultdict(list)
    cases: dict[str, list[DecidedCase]] = defaultdict(list)
    for row, drill in zip(drill_rows(data.drills), data.drills, strict=True):
        rows[row.trainee].append(row)
        cases[row.trainee] += drill.cases
    everything = drill_score.drill_score([case for own in cases.values() for case in own])
    missed = {fault: proportion(*counts) for fault, counts in everything.missed.items()}
    series = [
        ([[row.values[outcome.name] for row in own] for own in rows.values()], outcome.better)
        for outcome in TESTED
    ]
    return Decisions(
        rows,
        cases,
        dict(sorted(missed.items(), key=lambda each: (-each[1].share, -each[1].total))),
        dict(zip(TESTED, cohort_trends(series), strict=True)),
        sum(record.task == DECIDE for record in data.aborted),
        _before_and_after(data, rows),
    )


def _before_and_after(
    data: StudyData, rows: dict[str, list[TrialRow]]
) -> tuple[ModeComparison, ...]:
    """Compare the first drill with the last of the trainees who did trials between them."""
    found = []
    for trainee, (first, *_, last) in ((who, own) for who, own in rows.items() if len(own) > 1):
        start, end = moment(first.completed_utc), moment(last.started_utc)
        trials = (trial for trial in data.trials if trial.trainee == trainee)
        if any(start < moment(trial.started_utc) < end for trial in trials):
            for drill, when in ((first, BEFORE), (last, AFTER)):
                found.append(TrialRow(trainee, when, drill.task, values=drill.values))
    names = [outcome.name for outcome in TESTED]
    return compare_modes(StudyData("", tuple(found)), TESTED, BEFORE, AFTER, names)


def decisions(found: Decisions | None) -> Markup:
    """Return the section; "" without drills."""
    if found is None:
        return Markup()
    scores = {name: drill_score.drill_score(own) for name, own in sorted(found.cases.items())}
    cases = [case for own in found.cases.values() for case in own]
    drills = [
        {
            name: [(float(row.number), row.values[outcome.name]) for row in own]
            for name, own in found.rows.items()
        }
        for outcome in TESTED
    ]
    longest = max(map(len, found.rows.values()))
    compared = len(found.trained[0].trainees) if found.trained else 0
    columns = zip(
        *(
            (s.sensitivity.value, s.criterion.value, s.mean_cost, s.score, s.ability.value, s.brier)
            for s in scores.values()
        ),
        strict=True,
    )
    return render(
        "decisions",
        found=found,
        cases=cases,
        drills=sum(map(len, found.rows.values())),
        wrong=_shares(cases, lambda case: case.is_sound, lambda case: not case.is_right),
        scores=scores,
        means=[_mean(values) for values in columns],
        scoring=drill_score,
        reliability=charts.reliability_chart(_shares(cases, lambda case: case.confidence)),
        sureness=_mean(
            float(np.mean([c.confidence - 100 * c.is_right for c in own]))
            for own in found.cases.values()
        ),
        named=_shares(
            [case for case in cases if case.is_right and not case.is_sound],
            lambda case: case.fault,
            lambda case: case.suspected is case.fault,
        ),
        right=_shares(cases, lambda case: case.decision),
        answers={
            decision: own
            for decision in Decision
            if (own := [case for case in cases if case.decision is decision])
        },
        blocks=[_block(found, number) for number in range(1, longest + 1)],
        trends=[
            (outcome, "all", trend, len(found.rows)) for outcome, trend in found.trends.items()
        ],
        verdicts=list(TrendVerdict),
        curves=[
            charts.learning_curves(outcome.heading, COLOR, own, "drill")
            for outcome, own in zip(TESTED, drills, strict=True)
        ],
        effect=detectable_effect(compared) if compared > 1 else None,
        compared=compared,
        pairs=[charts.paired_lines(comparison) for comparison in found.trained],
    )


def _shares(
    cases: Sequence[DecidedCase],
    group: Callable[[DecidedCase], Group],
    is_counted: Callable[[DecidedCase], bool] = lambda case: case.is_right,
) -> dict[Group, Proportion]:
    """Return how many cases of each group are counted; by default, those decided rightly."""
    counted: dict[Group, list[bool]] = defaultdict(list)
    for case in cases:
        counted[group(case)].append(is_counted(case))
    return {name: proportion(sum(own), len(own)) for name, own in counted.items()}


def _mean(values: Iterable[float]) -> Estimate | None:
    """Return the mean over trainees; None of a single one."""
    of_all = np.fromiter(values, float)
    return mean(of_all) if len(of_all) > 1 else None


def _block(found: Decisions, number: int) -> tuple[int, int, list[Estimate | None], Proportion]:
    """Return number, trainees, means of the outcomes, and who passed, of all drills of a number."""
    rows = [own[number - 1] for own in found.rows.values() if len(own) >= number]
    means = [_mean(row.values[outcome.name] for row in rows) for outcome in TESTED]
    return number, len(rows), means, proportion(sum(row.acceptable for row in rows), len(rows))
