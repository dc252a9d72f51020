"""What the comparison of modes shows on the means of the trainees, and how sure it is."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.inference.few_subjects import what_it_shows
from rastrainer.inference.paired import equivalence_margin
from rastrainer.number_text import fixed
from rastrainer.report.charts.effect_sizes import effect_sizes
from rastrainer.report.charts.paired_lines import paired_lines
from rastrainer.report.comparisons import ModeComparison
from rastrainer.report.markup import Cell, figure, paragraph, section, table
from rastrainer.report.outcomes import mode_name, mode_title


def findings(comparisons: Sequence[ModeComparison]) -> list[str]:
    """Return a sentence for each outcome that was tested."""
    return [
        what_it_shows(
            comparison.outcome.title,
            comparison.outcome.unit,
            mode_name(comparison.first),
            mode_name(comparison.second),
            comparison.result,
            comparison.adjusted_p,
        )
        for comparison in comparisons
        if comparison.result is not None and comparison.adjusted_p is not None
    ]


def paired_statistics(comparisons: Sequence[ModeComparison]) -> str:
    """Return tables, charts and sentences; "" where no trainee did two modes."""
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
        figure(
            [paired_lines(comparison) for comparison in comparisons[:6]],
            "Every trainee's means in both modes (thick: the mean of all), and the mean difference "
            "with its 95 % interval on an axis of its own.",
        ),
        figure([effect_sizes(comparisons)], "Standardized paired differences.")
        if any(comparison.result for comparison in comparisons)
        else "",
    )


def p_text(p: float) -> str:
    """Return a p-value as papers print it."""
    return "< .001" if p < 0.001 else f"{p:.3f}".lstrip("0")


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
    ]
    return table([[*headers, "Wilcoxon p", "g_z"]], rows, "wide")


def _row(comparison: ModeComparison) -> list[Cell | str]:
    outcome, result = comparison.outcome, comparison.result
    means = [outcome.text(float(values.mean())) for values in _both(comparison)]
    start = [outcome.heading, str(len(comparison.trainees)), *means]
    if result is None:
        return [*start, Cell(comparison.reason, 7, kind="text")]
    ranks = result.signed_ranks
    return [
        *start,
        interval_text(result.mean_difference, result.interval, outcome.digits + 1),
        fixed(equivalence_margin(result), outcome.digits + 1),
        fixed(result.t, 2),
        p_text(result.p),
        "–" if comparison.adjusted_p is None else p_text(comparison.adjusted_p),
        "–" if ranks is None else p_text(ranks.p),
        fixed(result.hedges_gz, 2),
    ]


def interval_text(value: float, interval: tuple[float, float], digits: int) -> str:
    """Return a value with its interval, such as `0.15 [0.08, 0.21]`."""
    low, high = interval
    return f"{fixed(value, digits)} [{fixed(low, digits)}, {fixed(high, digits)}]"


def _both(comparison: ModeComparison):
    return comparison.first_means, comparison.second_means
