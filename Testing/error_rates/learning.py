"""Whether trainees improve: false alarms in constant series, and detected trends."""

from __future__ import annotations

import numpy as np

from rastrainer.study.outcomes import MAIN_OUTCOMES
from rastrainer.study.study_data import StudyData
from rastrainer_simulator.report.comparisons import CONFIRMATORY, compare_modes
from rastrainer_simulator.report.trainees import groups, learning_trends
from rastrainer_simulator.statistics.trend import ALPHA, TrendVerdict, cohort_trend_p, falling_trend
from rastrainer_simulator.virtual.outcome_model import OutcomeModel
from Testing.drawn_study import draw_study
from Testing.error_rates.measured import Measured, share_of, share_text

HEADER = ("series of one trainee", "shown to fall", "steady", "undecided")
COHORT_HEADER = ("12 trainees, 5 trials each", "shown to fall")
NULL_HEADER = ("what the report says", "said falsely", "without correction")


def _noise(kind: str, random: np.random.Generator, shape: tuple[int, int]) -> np.ndarray:
    """Return noise of standard deviation 1 (t with 3 degrees of freedom: of scale 1)."""
    if kind == "normal":
        return random.normal(size=shape)
    if kind == "skewed":
        values = np.exp(random.normal(0, 0.8, shape))
        return (values - np.exp(0.32)) / np.sqrt((np.exp(0.64) - 1) * np.exp(0.64))
    return random.standard_t(3, shape)


def falling(trials: int, first: float = 140.0, last: float = 107.0) -> np.ndarray:
    """Return times that fall by a power law of practice, (n,) float, in s."""
    return first * np.arange(1, trials + 1) ** (np.log(last / first) / np.log(trials))


def series(sets: int, seed: int = 1) -> list[Measured]:
    """Return the figures of single trainees."""
    random = np.random.default_rng(seed)
    constant = [("normal", n, 5.0) for n in (4, 5, 6, 8, 12)]
    constant += [("skewed", 5, 15.0), ("heavy-tailed", 5, 5.0), ("skewed", 12, 15.0)]
    cases = [
        (f"constant 120 s, {kind} with SD {sd:g} s, {n} trials", np.full(n, 120.0), kind, sd, "≤")
        for kind, n, sd in constant
    ]
    found = "140 → 107 s, power law, SD"
    even, early = np.linspace(140, 107, 5), 107 + 33 * np.exp(-np.arange(5) / 1.2)
    cases += [
        (f"{found} 5 s, 5 trials", falling(5), "normal", 5.0, "≥"),
        ("140 → 107 s, exponential, SD 5 s, 5 trials", early, "normal", 5.0, "≥"),
        ("140 → 107 s, equal steps, SD 5 s, 5 trials", even, "normal", 5.0, "≥"),
        (f"{found} 10 s, 5 trials", falling(5), "normal", 10.0, ""),
        (f"{found} 10 s, 10 trials", falling(10), "normal", 10.0, ""),
        (f"{found} 5 s, 4 trials", falling(4), "normal", 5.0, ""),
        ("rising 107 → 140 s, SD 5 s, 5 trials", falling(5)[::-1], "normal", 5.0, "≤"),
        ("constant 120 s, SD 2 s, 5 trials", np.full(5, 120.0), "normal", 2.0, "≤"),
    ]
    return [_series(*case, sets, random) for case in cases]


def _series(
    words: str,
    means: np.ndarray,
    kind: str,
    sd: float,
    asked: str,
    sets: int,
    random: np.random.Generator,
) -> Measured:
    rows = means + sd * _noise(kind, random, (sets, len(means)))
    verdicts = [falling_trend(row).verdict for row in rows]
    shares = {one: share_of([verdict is one for verdict in verdicts]) for one in TrendVerdict}
    return Measured(
        words,
        shares[TrendVerdict.FALLS],
        sets,
        at_most=0.06 if asked == "≤" else None,
        at_least=0.8 if asked == "≥" else None,
        further=tuple(
            share_text(shares[one]) for one in (TrendVerdict.STEADY, TrendVerdict.UNDECIDED)
        ),
    )


def cohorts(sets: int, seed: int = 2) -> list[Measured]:
    """Return the figures of Page's test."""
    random = np.random.default_rng(seed)
    cases = [
        ("constant, log-normal scatter of 12 %, trainees differ by 20 %", np.ones(5), 0.06, None),
        ("falling by 10 %, otherwise as above", falling(5, 1.0, 0.9), None, None),
        ("falling by 15 %, otherwise as above", falling(5, 1.0, 0.85), None, 0.8),
    ]
    found = []
    for words, means, at_most, at_least in cases:
        own = random.normal(0, 0.2, (sets, 12, 1))
        rows = 120 * means * np.exp(own + random.normal(0, 0.12, (sets, 12, 5)))
        shown = [cohort_trend_p(study) < 0.05 for study in rows]
        found.append(Measured(words, share_of(shown), sets, at_most, at_least))
    return found


def null_cohorts(sets: int, seed: int = 3) -> list[Measured]:
    """Return how often reports say something false of a quarter as many cohorts without effects.

    Their 12 trainees do five tasks in two modes, of which half begin with each, and do not improve.
    """
    random = np.random.default_rng(seed)
    model = OutcomeModel([105.0, 125.0, 130.0, 135.0, 140.0], [1.5] * 5, learning=0.0)
    orders = [("desktop", "hmd"), ("hmd", "desktop")] * 6
    cohorts = [draw_study(model, 12, orders[0], random, orders) for _ in range(max(1, sets // 4))]
    # Each column is a statement; the last one stands for any.
    said, uncorrected = (
        np.column_stack([own, own.any(axis=1)])
        for own in map(np.array, zip(*map(_said, cohorts), strict=True))
    )
    words = ("trainees get better (6 tests)", "modes differ (3 tests)", "there are groups", "any")
    return [
        Measured(
            statement,
            share_of(said[:, column]),
            len(cohorts),
            at_most=0.06 if statement != "any" else 0.11,
            further=(share_text(share_of(uncorrected[:, column])),),
        )
        for column, statement in enumerate(words)
    ]


def _said(study: StudyData) -> tuple[list[bool], list[bool]]:
    """Return whether each statement is made, and whether it would be without correction."""
    trends = [trend for trend in learning_trends(study).values() if trend is not None]
    found = compare_modes(study, MAIN_OUTCOMES, "desktop", "hmd")
    modes = [one for one in found if one.outcome.name in CONFIRMATORY]
    has_groups = "None are reported" not in groups(study)
    said = [
        any(trend.is_shown for trend in trends),
        any(one.adjusted_p < ALPHA for one in modes),
        has_groups,
    ]
    uncorrected = [
        any(trend.p < ALPHA for trend in trends),
        any(one.result.p < ALPHA for one in modes),
        has_groups,
    ]
    return said, uncorrected
