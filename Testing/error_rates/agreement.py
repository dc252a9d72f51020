"""How often the intervals of raters' agreement hold the truth."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable, Sequence

import numpy as np

from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer_simulator.statistics.agreement import (
    Agreement,
    intraclass_correlations,
    kappa_of_table,
    quadratic_kappa,
)
from Testing.error_rates.measured import Measured, holds, share_of, share_text

HEADER = (
    "raters",
    "interval contains the truth",
    "truth",
    "mean width of the interval",
    "no interval",
)
REPLAYS = (10, 20, 40)
RATERS, RATED = (2, 3, 5), (10, 40)
LOWEST, HIGHEST = 1, 5
TOTALS = ((0.3, 0.6), (1.0, 0.5), (1.0, 1.0))
"""Standard deviations between raters and of the rest, in those between replays."""
MARKS = ((0.3, 0.4), (0.3, 0.8))
"""The second rater's mildness, and the standard deviation of a mark, in standard deviations between
replays."""
ASKED = 0.94
ASKED_OF_FEW = 0.92
"""Least coverage of kappa below 40 replays."""
SEED = 20240


def intervals(sets: int) -> Sequence[Measured]:
    """Return the coverage for totals and for single marks."""
    found = []
    for (between, rest), raters, replays in itertools.product(TOTALS, RATERS, RATED):
        case = f"ICC(2,1), {raters} raters, SD between them {between:g}, rest {rest:g}"
        case = f"{case}, {replays} replays"
        draw = functools.partial(_totals, replays, raters, between, rest)
        truth = 1.0 / (1.0 + between**2 + rest**2)
        found.append(_measured(case, draw, _single, truth, sets, ASKED))
    for milder, rest in MARKS:
        truth = _true_kappa(milder, rest)
        for replays in REPLAYS:
            draw = functools.partial(_marks, replays, milder, rest)
            case = f"kappa, one rater milder by {milder:g}, rest {rest:g}, {replays} replays"
            asked = ASKED if replays >= REPLAYS[-1] else ASKED_OF_FEW
            found.append(_measured(case, draw, _kappa, truth, sets, asked))
    return found


def _measured(
    case: str,
    draw: Callable[[np.random.Generator], np.ndarray],
    rate: Callable[[np.ndarray], Agreement],
    truth: float,
    sets: int,
    asked: float,
) -> Measured:
    random = np.random.default_rng([SEED, *case.encode()])
    agreements, missing = [], 0
    for _ in range(sets):
        try:
            agreement = rate(draw(random))
        except InputError:
            missing += 1
            continue
        missing += agreement.interval is None
        agreements += [agreement] if agreement.interval is not None else []
    widths = [each.interval[1] - each.interval[0] for each in agreements]
    share = share_of([holds(each.interval, truth) for each in agreements])
    further = (fixed(truth, 2), fixed(float(np.mean(widths)), 2), share_text(missing / sets))
    return Measured(case, share, len(agreements), at_least=asked, further=further)


def _totals(
    replays: int, raters: int, between: float, rest: float, random: np.random.Generator
) -> np.ndarray:
    """Return the totals (n, k) of raters who were drawn from many."""
    quality, leniency = random.normal(0.0, 1.0, (replays, 1)), random.normal(0.0, between, raters)
    return quality + leniency + random.normal(0.0, rest, (replays, raters))


def _single(totals: np.ndarray) -> Agreement:
    return intraclass_correlations(totals).single


def _marks(replays: int, milder: float, rest: float, random: np.random.Generator) -> np.ndarray:
    """Return marks (2, n) int of the same replays by two raters, 1 to 5."""
    quality = random.normal(3.0, 1.0, replays)
    marks = [quality + offset + random.normal(0.0, rest, replays) for offset in (0.0, milder)]
    return np.clip(np.rint(marks), LOWEST, HIGHEST).astype(int)


def _kappa(marks: np.ndarray) -> Agreement:
    return quadratic_kappa(*marks, LOWEST, HIGHEST)


@functools.lru_cache
def _true_kappa(milder: float, rest: float) -> float:
    """Return the kappa of a million replays."""
    first, second = _marks(1_000_000, milder, rest, np.random.default_rng(SEED))
    table = np.zeros((5, 5))
    np.add.at(table, (first - 1, second - 1), 1.0)
    apart = np.subtract.outer(np.arange(5), np.arange(5))
    return kappa_of_table(table, 1.0 - (apart / 4) ** 2)
