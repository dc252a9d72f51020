"""The comparison of modes on the means of trainees, with its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from rastrainer.number_text import fixed, signed
from rastrainer.study.outcomes import mode_name
from rastrainer_simulator.report import charts
from rastrainer_simulator.report.comparisons import ModeComparison, tested
from rastrainer_simulator.report.page import render
from rastrainer_simulator.statistics.intervals import ALPHA
from rastrainer_simulator.statistics.paired import PairedComparison, equivalence_margin

SAME_ORDER = (
    "The order of the modes does not allow the effect of the period (practice, fatigue) to be "
    "separated: it is part of the differences."
)
UNKNOWN_ORDER = (
    "Which mode came first is not in the data: the effect of the period (practice, fatigue) is "
    "part of the differences, or of their scatter."
)
MAX_PAIRED_CHARTS = 6


def findings(comparisons: Sequence[ModeComparison]) -> list[str]:
    return [
        what_it_shows(
            comparison.outcome.title,
            comparison.outcome.unit,
            mode_name(comparison.first),
            mode_name(comparison.second),
            result,
            comparison.adjusted_p,
            comparison.outcome.digits + 1,
        )
        for comparison, result in tested(comparisons)
        if comparison.adjusted_p is not None
    ]


def what_it_shows(
    name: str,
    unit: str,
    first: str,
    second: str,
    comparison: PairedComparison,
    adjusted_p: float,
    digits: int = 2,
    several: str = "outcomes",
) -> str:
    """Return a sentence that says what the comparison, second minus first, shows, never more."""
    difference = comparison.mean_difference
    low, high = (signed(end, digits) for end in comparison.interval)
    span = f"from {low} to {high} {unit}".rstrip()
    if comparison.p >= ALPHA:
        return (
            f"{name}: no difference is shown. The data are compatible with anything {span}; that "
            "is not evidence that there is none."
        )
    amount = f"{fixed(abs(difference), digits)} {unit}".rstrip()
    direction = "higher" if difference > 0 else "lower"
    shown = (
        f"{name} was {amount} {direction} with {second} than with {first} (95 % interval {span})"
    )
    if adjusted_p < ALPHA:
        return f"{shown}; this holds after correction for testing several {several}."
    return f"{shown}, but this does not hold after correction for testing several {several}."


def paired_statistics(comparisons: Sequence[ModeComparison]) -> Markup:
    """Return tables, charts and sentences; "" if no trainee did two modes."""
    if not comparisons:
        return Markup()
    results = tested(comparisons)
    has_effects = any(result.gz_interval for _one, result in results)
    return render(
        "paired_statistics",
        first=comparisons[0].first,
        second=comparisons[0].second,
        comparisons=comparisons,
        margin=equivalence_margin,
        separated=[
            (comparison.outcome, result.sequences)
            for comparison, result in results
            if result.sequences is not None
        ],
        caveat=order_caveat(comparisons),
        charts=[charts.paired_lines(one) for one in comparisons[:MAX_PAIRED_CHARTS]],
        effects=charts.effect_sizes(comparisons) if has_effects else None,
    )


def order_caveat(comparisons: Sequence[ModeComparison]) -> str:
    """Return why the effect of the period is not separated; "" if it is."""
    if any(result.sequences is not None for _one, result in tested(comparisons)):
        return ""
    known = any(comparison.order is not None for comparison in comparisons)
    return SAME_ORDER if known else UNKNOWN_ORDER
