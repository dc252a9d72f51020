"""How often the intervals of raters' agreement hold the truth."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence

import numpy as np

from rastrainer.errors import InputError
from rastrainer.number_text import fixed
from rastrainer.statistics.agreement import (
    Agreement,
    intraclass_correlations,
    kappa_of_table,
    quadratic_kappa,
)
from Testing.error_rates.measured import Measured, share_text

HEADER = (
    "two raters",
    "interval contains the truth",
    "truth",
    "mean width of the interval",
    "no interval",
)
REPLAYS = (10, 20, 40)
LOWEST, HIGHEST = 1, 5
TOTALS = ((0.3, 0.6), (0.5, 1.0))
"""Standard deviations between raters and of the rest, in those between replays."""
MARKS = ((0.3, 0.4), (0.3, 0.8))
"""By how much the second rater is milder, and the standard deviation of a mark, in those between
replays."""
ASKED = 0.94
ASKED_OF_FEW = 0.92
"""Of kappa, below 40 replays."""
SEED = 20240


def intervals(sets: int) -> Sequence[Measured]:
    """Return the coverage for totals and for single marks."""
    found = []
    for between, rest in TOTALS:
        truth = 1.0 / (1.0 + between**2 + rest**2)
        for replays in REPLAYS:
            draw = functools.partial(_single, replays, between, rest)
            case = f"ICC(2,1), raters differ by SD {between:g}, rest {rest:g}, {replays} replays"
            found.append(_measured(case, draw, truth, sets, ASKED))
    truth = 2.0 / (2.0 + TOTALS[0][0] ** 2 + TOTALS[0][1] ** 2)
    for replays in REPLAYS:
        draw = functools.partial(_average, replays, *TOTALS[0])
        case = "ICC(2,k), raters differ by SD {:g}, rest {:g}, {} replays"
        found.append(_measured(case.format(*TOTALS[0], replays), draw, truth, sets, ASKED))
    for milder, rest in MARKS:
        truth = _true_kappa(milder, rest)
        for replays in REPLAYS:
            draw = functools.partial(_kappa, replays, milder, rest)
            case = f"kappa, one rater milder by {milder:g}, rest {rest:g}, {replays} replays"
            asked = ASKED if replays >= REPLAYS[-1] else ASKED_OF_FEW
            found.append(_measured(case, draw, truth, sets, asked))
    return found


def _measured(
    case: str,
    draw: Callable[[np.random.Generator], Agreement],
    truth: float,
    sets: int,
    asked: float,
) -> Measured:
    random = np.random.default_rng([SEED, *case.encode()])
    agreements, missing = [], 0
    for _ in range(sets):
        try:
            agreement = draw(random)
        except InputError:
            missing += 1
            continue
        missing += agreement.interval is None
        agreements += [agreement] if agreement.interval is not None else []
    widths = [each.interval[1] - each.interval[0] for each in agreements]
    share = float(np.mean([each.holds(truth) for each in agreements]))
    beside = (fixed(truth, 2), fixed(float(np.mean(widths)), 2), share_text(missing / sets))
    return Measured(case, share, len(agreements), at_least=asked, beside=beside)


def _totals(replays: int, between: float, rest: float, random: np.random.Generator) -> np.ndarray:
    """Return the totals (n, 2) of two raters who were drawn from many."""
    quality = random.normal(0.0, 1.0, (replays, 1))
    return quality + random.normal(0.0, between, (1, 2)) + random.normal(0.0, rest, (replays, 2))


def _single(replays: int, between: float, rest: float, random: np.random.Generator) -> Agreement:
    return intraclass_correlations(_totals(replays, between, rest, random)).single


def _average(replays: int, between: float, rest: float, random: np.random.Generator) -> Agreement:
    return intraclass_correlations(_totals(replays, between, rest, random)).average


def _marks(
    replays: int, milder: float, rest: float, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Return marks (n,) of the same replays by two raters, 1 to 5."""
    quality = random.normal(3.0, 1.0, replays)
    first, second = (
        np.clip(np.rint(quality + offset + random.normal(0.0, rest, replays)), LOWEST, HIGHEST)
        for offset in (0.0, milder)
    )
    return first.astype(int), second.astype(int)


def _kappa(replays: int, milder: float, rest: float, random: np.random.Generator) -> Agreement:
    return quadratic_kappa(*_marks(replays, milder, rest, random), LOWEST, HIGHEST)


@functools.lru_cache
def _true_kappa(milder: float, rest: float) -> float:
    """Return the kappa of a million replays."""
    first, second = _marks(1_000_000, milder, rest, np.random.default_rng(SEED))
    table = np.zeros((5, 5))
    np.add.at(table, (first - 1, second - 1), 1.0)
    apart = np.subtract.outer(np.arange(5), np.arange(5))
    return kappa_of_table(table, 1.0 - (apart / 4) ** 2)
