"""The comparison of modes on the means of trainees, with its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.number_text import fixed, p_text
from rastrainer.report.elements.charts import effect_sizes, paired_lines
from rastrainer.report.elements.comparisons import ModeComparison, tested
from rastrainer.report.elements.markup import Cell, Line, figure, heading, paragraph, section, table
from rastrainer.statistics.few_subjects import what_it_shows
from rastrainer.statistics.paired import equivalence_margin
from rastrainer.study.outcomes import mode_name, mode_title

SEPARATED = (
    "Trainees did the modes in different orders, so that the effect of the period (practice, "
    "fatigue) can be separated: difference, t-test and effect size above are free of it (the "
    "differences are regressed on the order; with two sequences this is the usual analysis of a "
    "crossover), and the rank test compares the later minus the earlier period between the "
    "sequences. “Between sequences” is the mean over both modes of those who began with {second}, "
    "minus that of those who began with {first}. It differs from 0 by chance, or where one mode "
    "leaves more behind for the other than the other way round; that carry-over would be in the "
    "difference of the modes, too."
)
SAME_ORDER = (
    "The order of the modes does not allow the effect of the period (practice, fatigue) to be "
    "separated: it is part of the differences."
)
UNKNOWN_ORDER = (
    "Which mode came first is not in the data: the effect of the period (practice, fatigue) is "
    "part of the differences, or of their scatter."
)


def findings(comparisons: Sequence[ModeComparison]) -> list[str]:
    """Return a sentence for each tested outcome."""
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


def paired_statistics(comparisons: Sequence[ModeComparison]) -> str:
    """Return tables, charts and sentences; "" if no trainee did two modes."""
    if not comparisons:
        return ""
    first, second = (mode_title(m) for m in (comparisons[0].first, comparisons[0].second))
    intro = (
        f"Each trainee counts once, with the mean over the tasks done in both modes. Differences "
        f"are {second} minus {first}. “Equivalent within ±” is the least margin within which two "
        "one-sided tests at the 5 % level show the true difference to lie; how small a difference "
        "may be neglected must be decided before the study."
    )
    return section(
        "Paired statistics",
        paragraph(intro),
        _table(comparisons),
        *_order(comparisons),
        figure(
            [paired_lines(comparison) for comparison in comparisons[:6]],
            "Every trainee's means in both modes (thick: the mean of all), and the mean difference "
            "with its 95 % interval on an axis of its own.",
        ),
        figure([effect_sizes(comparisons)], "Standardized paired differences.")
        if any(result.gz_interval for _one, result in tested(comparisons))
        else "",
    )


def order_caveat(comparisons: Sequence[ModeComparison]) -> str:
    """Return why the effect of the period is not separated; "" if it is."""
    if any(result.sequences is not None for _one, result in tested(comparisons)):
        return ""
    known = any(comparison.order is not None for comparison in comparisons)
    return SAME_ORDER if known else UNKNOWN_ORDER


def _order(comparisons: Sequence[ModeComparison]) -> list[str]:
    """Return the effects of the order, or why they are unknown."""
    separated = [
        (comparison, result.sequences)
        for comparison, result in tested(comparisons)
        if result.sequences is not None
    ]
    if not separated:
        return [paragraph(order_caveat(comparisons))]
    one = separated[0][0]
    first, second = mode_name(one.first), mode_name(one.second)
    rows = []
    for comparison, found in separated:
        digits = comparison.outcome.digits + 1
        between = "–"
        if found.between is not None and found.between_interval is not None:
            between = interval_text(found.between, found.between_interval, digits)
        later = interval_text(found.later, found.later_interval, digits)
        counts = [str(found.first_first), str(found.second_first)]
        rows.append([comparison.outcome.heading, *counts, later, between])
    header = [
        "Outcome",
        *(f"n, {mode_title(mode).split(' ')[0]} first" for mode in (one.first, one.second)),
        "one period later [95\N{NO-BREAK SPACE}%]",
        "between sequences [95\N{NO-BREAK SPACE}%]",
    ]
    return [
        heading("What the order of the modes did"),
        table([header], rows, "wide"),
        paragraph(SEPARATED.format(first=first, second=second), "small"),
    ]


def _table(comparisons: Sequence[ModeComparison]) -> str:
    rows = [_row(comparison) for comparison in comparisons]
    modes = [
        mode_title(mode).split(" ")[0] for mode in (comparisons[0].first, comparisons[0].second)
    ]
    headers = [
        "Outcome",
        "n",
        *modes,
        "difference [95 %]",
        "equivalent within ±",
        "t",
        "p",
        "p (Holm)",
        "rank test p",
    ]
    return table([[*headers, "g_z"]], rows, "wide")


def _row(comparison: ModeComparison) -> Line:
    outcome, result = comparison.outcome, comparison.result
    both = (comparison.first_means, comparison.second_means)
    means = [outcome.text(float(values.mean())) for values in both]
    start = [outcome.heading, str(len(comparison.trainees)), *means]
    if result is None:
        return [*start, Cell(comparison.reason, 7, kind="text")]
    return [
        *start,
        interval_text(result.mean_difference, result.interval, outcome.digits + 1),
        fixed(equivalence_margin(result), outcome.digits + 1),
        fixed(result.t, 2),
        p_text(result.p),
        "–" if comparison.adjusted_p is None else p_text(comparison.adjusted_p),
        "–" if result.ranks is None else p_text(result.ranks.p),
        "–" if result.hedges_gz is None else fixed(result.hedges_gz, 2),
    ]


def interval_text(value: float, interval: tuple[float, float], digits: int) -> str:
    """Return a value with its interval, such as `0.15 [0.08, 0.21]`."""
    low, high = interval
    return f"{fixed(value, digits)} [{fixed(low, digits)}, {fixed(high, digits)}]"
