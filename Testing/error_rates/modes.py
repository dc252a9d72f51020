"""Two modes on the same trainees: the effect of their order, and the interval of Hedges' gz."""

from __future__ import annotations

import numpy as np
from scipy import stats

from rastrainer_simulator.statistics.paired import compare_paired, fit_differences, rank_test
from rastrainer_simulator.virtual.outcome_model import OutcomeModel, rejection_rates
from Testing.error_rates.measured import Measured, share_of, share_text

COVERAGE = "coverage of the 95 % interval"
HEADER = (
    "trainees in two sequences",
    "period separated",
    "paired t-test",
    "rank sums",
    COVERAGE,
)
STUDY_HEADER = ("outcome", "p (Holm) < .05", "p < .05", "rank test", COVERAGE)
MODES = ("desktop", "hmd")


def sequences(sets: int, seed: int = 5) -> list[Measured]:
    """Return the shares of differences of modes that are found, by analysis."""
    cases = [
        ("6 and 6, true 6 s", 6, 6, 6.0, 10.0, "normal", None, 0.8),
        ("6 and 6, true 6 s, no effect of the period", 6, 6, 6.0, 0.0, "normal", None, 0.8),
        ("3 and 3, true 6 s", 3, 3, 6.0, 10.0, "normal", None, None),
        ("8 and 4, true 6 s", 8, 4, 6.0, 10.0, "normal", None, 0.8),
    ]
    cases += [
        (f"{both[0]} and {both[1]}, no difference, {kind}", *both, 0.0, 10.0, kind, 0.06, None)
        for both in ((2, 2), (6, 6), (8, 4), (20, 20))
        for kind in ("normal", "log-normal values")
    ]
    random = np.random.default_rng(seed)
    return [_sequences(*case, sets, random) for case in cases]


def _sequences(
    words: str,
    one: int,
    other: int,
    difference: float,
    period: float,
    kind: str,
    at_most: float | None,
    at_least: float | None,
    sets: int,
    random: np.random.Generator,
) -> Measured:
    """Return the shares for differences that scatter with an SD of 6 s about mode and period."""
    order = np.repeat([1.0, -1.0], [one, other])
    noise = random.normal(size=(sets, one + other))
    if kind == "log-normal values":
        # Each mode's value is skewed: their difference has heavy tails.
        values = np.exp(0.8 * np.stack([noise, random.normal(size=noise.shape)]))
        noise = np.diff(values, axis=0)[0] / np.sqrt(2 * (np.exp(0.64) - 1) * np.exp(0.64))
    rows = difference + period * order + 6.0 * noise
    shares = []
    for own in (order, None):
        fit = fit_differences(rows, own)
        students = stats.t
        p_values = 2 * students.sf(np.abs(fit.mean / fit.standard_error), fit.dof)
        shares.append(share_of(p_values < 0.05))
        if own is not None:
            reach = students.ppf(0.975, fit.dof) * fit.standard_error
            coverage = share_of(np.abs(fit.mean - difference) <= reach)
    ranks = share_of([rank_test(row, order).p < 0.05 for row in rows])
    further = tuple(share_text(share) for share in (shares[1], ranks, coverage))
    return Measured(words, shares[0], sets, at_most, at_least, further)


def studies(sets: int, seed: int = 6) -> list[Measured]:
    """Return the result of `rastrainer simulate-cohort --power` for the published protocol."""
    found = []
    orders = [MODES, MODES[::-1]] * 6
    for words, time, error in (("equal modes", 1.0, 1.0), ("headset 8 %/20 % worse", 1.08, 1.2)):
        model = OutcomeModel(
            [105.0, 125.0, 130.0, 135.0, 140.0],
            [1.5] * 5,
            learning=0.15,
            carries_practice=True,
            mode_time={"hmd": time},
            mode_fle={"hmd": error},
        )
        for rates in rejection_rates(model, 12, MODES, sets, seed, orders):
            coverage = "–" if rates.coverage is None else share_text(rates.coverage)
            found.append(
                Measured(
                    f"{words}: {rates.outcome}",
                    rates.holm,
                    sets,
                    at_most=0.06 if time == 1.0 else None,
                    further=(share_text(rates.t_test), share_text(rates.ranks), coverage),
                )
            )
    return found


EFFECT_HEADER = ("paired trainees", "interval contains the truth")
TRUTHS = (0.0, 0.5, 1.5)
MORE = 10
"""Times as many data sets as are asked for: a share of 95 % is to be distinguished from 94 %."""
COMPUTED = 3
"""Sets whose interval is computed: to see whether t is in its tails is the same."""


def coverage(sets: int, seed: int = 7) -> list[Measured]:
    """Return the coverage without an order, and for four and twelve trainees in two sequences."""
    random = np.random.default_rng(seed)
    cases = [(n, truth, False) for n in (3, 4, 8, 20) for truth in TRUTHS]
    cases += [(4, 0.5, True), (12, 1.5, True)]
    return [_coverage(*case, MORE * sets, random) for case in cases]


def _coverage(
    n: int, truth: float, in_sequences: bool, sets: int, random: np.random.Generator
) -> Measured:
    order = np.where(np.arange(n) % 2, -1.0, 1.0) if in_sequences else None
    rows = random.normal(truth, 1.0, (sets, n)) + (2 * order if in_sequences else 0.0)
    fit = fit_differences(rows, order)
    held = _holds(fit.mean / fit.standard_error, fit.dof, truth * np.sqrt(n))
    for row, expected in zip(rows[:COMPUTED], held, strict=False):
        low, high = compare_paired(np.zeros(n), row, order).effect.interval
        assert (low <= truth <= high) == expected
    words = f"{n}, true effect {truth:g}" + (", two sequences" if in_sequences else "")
    return Measured(words, share_of(held), sets, at_least=0.94)


def _holds(t: np.ndarray, dof: int, noncentrality: float) -> np.ndarray:
    """Return whether the interval contains a noncentrality."""
    below = stats.nct.cdf(t, dof, noncentrality)
    # Far out in a tail, scipy gives no number.
    below = np.where(np.isnan(below), noncentrality < t, below)
    return (below >= 0.025) & (below <= 0.975)
