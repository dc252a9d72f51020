"""The comparison of modes on the means of trainees, with its uncertainty."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer.number_text import fixed, p_text, signed, significant
from rastrainer.report import page, svg
from rastrainer.report.comparisons import ModeComparison, tested
from rastrainer.statistics.intervals import ALPHA
from rastrainer.statistics.paired import PairedComparison, equivalence_margin
from rastrainer.study.outcomes import mode_name, mode_title, short_mode_title

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
    """Return a sentence that says what the comparison shows, never more.

    Args:
        comparison: Second minus first.
        digits: After the point, of the difference and its interval.
    """
    low, high = comparison.interval
    difference = comparison.mean_difference
    amount = f"{fixed(abs(difference), digits)} {unit}".rstrip()
    ends = [signed(end, digits) for end in (low, high)]
    span = f"from {ends[0]} to {ends[1]} {unit}".rstrip()
    direction = "higher" if difference > 0 else "lower"
    if adjusted_p < ALPHA:
        return (
            f"{name} was {amount} {direction} with {second} than with {first} "
            f"(95 % interval {span}); this holds after correction for testing several {several}."
        )
    if comparison.p < ALPHA:
        return (
            f"{name} was {amount} {direction} with {second} than with {first} (95 % interval "
            f"{span}), but this does not hold after correction for testing several {several}."
        )
    return (
        f"{name}: no difference is shown. The data are compatible with anything {span}; that is "
        "not evidence that there is none."
    )


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
    return page.section(
        "Paired statistics",
        page.paragraph(intro),
        _table(comparisons),
        *_order(comparisons),
        page.figure(
            [paired_lines(comparison) for comparison in comparisons[:6]],
            "Every trainee's means in both modes (thick: the mean of all), and the mean difference "
            "with its 95 % interval on an axis of its own.",
        ),
        page.figure([effect_sizes(comparisons)], "Standardized paired differences.")
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
        return [page.paragraph(order_caveat(comparisons))]
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
        *(f"n, {short_mode_title(mode)} first" for mode in (one.first, one.second)),
        "one period later [95\N{NO-BREAK SPACE}%]",
        "between sequences [95\N{NO-BREAK SPACE}%]",
    ]
    return [
        page.heading("What the order of the modes did"),
        page.table([header], rows, "wide"),
        page.paragraph(SEPARATED.format(first=first, second=second), "small"),
    ]


def _table(comparisons: Sequence[ModeComparison]) -> str:
    rows = [_row(comparison) for comparison in comparisons]
    modes = [short_mode_title(mode) for mode in (comparisons[0].first, comparisons[0].second)]
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
    return page.table([[*headers, "g_z"]], rows, "wide")


def _row(comparison: ModeComparison) -> page.Line:
    outcome, result = comparison.outcome, comparison.result
    both = (comparison.first_means, comparison.second_means)
    means = [outcome.text(float(values.mean())) for values in both]
    start = [outcome.heading, str(len(comparison.trainees)), *means]
    if result is None:
        return [*start, page.Cell(comparison.reason, 7, kind="text")]
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
    low, high = interval
    return f"{fixed(value, digits)} [{fixed(low, digits)}, {fixed(high, digits)}]"


PAIRED_WIDTH, PAIRED_HEIGHT = 330, 250
PAIRED_TOP, PAIRED_BOTTOM = 40, 212
PAIRED_LEFT, FIRST, SECOND = 44, 82, 176
DIFFERENCE = 268


def paired_lines(comparison: ModeComparison) -> str:
    """Return the chart of one outcome; differences have their own axis on the right."""
    outcome = comparison.outcome
    described = f"{outcome.title} of every trainee in both modes"
    sheet = svg.Sheet(PAIRED_WIDTH, PAIRED_HEIGHT, outcome.heading, described)
    both = np.concatenate([comparison.first_means, comparison.second_means])
    axis = svg.axis_over(both.tolist(), PAIRED_BOTTOM, PAIRED_TOP)
    svg.y_grid(sheet, axis, PAIRED_LEFT, SECOND + 22)
    colors = [
        svg.mode_color(mode, i) for i, mode in enumerate((comparison.first, comparison.second))
    ]
    opacity = 0.75 if len(comparison.trainees) <= 12 else max(0.12, 8 / len(comparison.trainees))
    pairs = zip(comparison.trainees, comparison.first_means, comparison.second_means, strict=True)
    for trainee, first, second in pairs:
        sheet.polyline(
            [(FIRST, axis.at(first)), (SECOND, axis.at(second))], svg.FAINT, 1.1, opacity
        )
        for x, value, color in ((FIRST, first, colors[0]), (SECOND, second, colors[1])):
            sheet.dot(
                x,
                axis.at(value),
                3.4,
                color,
                max(opacity, 0.5),
                f"{trainee}: {significant(value, 4)}",
            )
    means = [float(comparison.first_means.mean()), float(comparison.second_means.mean())]
    sheet.polyline([(FIRST, axis.at(means[0])), (SECOND, axis.at(means[1]))], svg.INK, 2.6)
    for x, mode in ((FIRST, comparison.first), (SECOND, comparison.second)):
        sheet.text(x, PAIRED_HEIGHT - 20, short_mode_title(mode), 11, svg.INK, "middle")
    _difference(sheet, comparison)
    return sheet.svg()


def _difference(sheet: svg.Sheet, comparison: ModeComparison) -> None:
    result = comparison.result
    if result is None:
        sheet.text(DIFFERENCE, (PAIRED_TOP + PAIRED_BOTTOM) / 2, "no test", 10, svg.FAINT, "middle")
        return
    low, high = result.interval
    axis = svg.axis_over([low, high, 0.0, 1.1 * low, 1.1 * high], PAIRED_BOTTOM, PAIRED_TOP)
    for tick in axis.ticks(4):
        y = axis.at(tick)
        sheet.line(DIFFERENCE - 22, y, DIFFERENCE + 22, y, "#9aa5b1" if tick == 0 else "#eceff2")
        sheet.text(DIFFERENCE + 28, y + 3.5, svg.number(tick), 9.5, svg.FAINT)
    sheet.line(DIFFERENCE, axis.at(low), DIFFERENCE, axis.at(high), svg.INK, 2)
    for end in (low, high):
        sheet.line(DIFFERENCE - 6, axis.at(end), DIFFERENCE + 6, axis.at(end), svg.INK, 2)
    sheet.dot(DIFFERENCE, axis.at(result.mean_difference), 5, svg.INK)
    sheet.text(DIFFERENCE, PAIRED_HEIGHT - 20, "difference", 11, svg.INK, "middle")
    sheet.text(DIFFERENCE, PAIRED_HEIGHT - 7, "mean, 95 % interval", 9, svg.FAINT, "middle")


EFFECTS_WIDTH, EFFECT_HEIGHT = 680, 27
EFFECTS_LEFT, EFFECTS_RIGHT = 226, 536
MAX_EFFECT_SIZE = 6.0


def effect_sizes(comparisons: Sequence[ModeComparison]) -> str:
    """Return the chart; intervals beyond the axis end in an arrow."""
    shown = [
        (comparison, result.hedges_gz, result.gz_interval)
        for comparison, result in tested(comparisons)
        if result.hedges_gz is not None and result.gz_interval is not None
    ]
    reach = max([1.0, *(abs(end) for _comparison, _gz, interval in shown for end in interval)])
    reach = min(MAX_EFFECT_SIZE, reach * 1.05)
    axis = svg.Axis(-reach, reach, EFFECTS_LEFT, EFFECTS_RIGHT)
    height = 64 + EFFECT_HEIGHT * len(shown)
    sheet = svg.Sheet(EFFECTS_WIDTH, height, "", "Effect sizes with their intervals")
    svg.x_grid(sheet, axis, 24, height - 32, 8, "#7b8794")
    for index, (comparison, gz, interval) in enumerate(shown):
        _effect_size(
            sheet, axis, 42 + EFFECT_HEIGHT * index, comparison.outcome.title, gz, interval
        )
    if shown:
        first, second = (mode_title(mode) for mode in (shown[0][0].first, shown[0][0].second))
        sheet.text(axis.at(0) - 8, 14, f"← higher with {first}", 10, svg.FAINT, "end")
        sheet.text(axis.at(0) + 8, 14, f"higher with {second} →", 10, svg.FAINT)
    sheet.text(
        (EFFECTS_LEFT + EFFECTS_RIGHT) / 2,
        height - 3,
        "Hedges' g_z with 95 % interval",
        10,
        svg.FAINT,
        "middle",
    )
    return sheet.svg()


def _effect_size(
    sheet: svg.Sheet, axis: svg.Axis, y: float, title: str, gz: float, interval: tuple[float, float]
) -> None:
    low, high = interval
    sheet.text(EFFECTS_LEFT - 14, y + 4, title, 11, svg.INK, "end")
    ends = [max(low, axis.low), min(high, axis.high)]
    sheet.line(axis.at(ends[0]), y, axis.at(ends[1]), y, svg.INK, 2)
    if low < axis.low:
        sheet.text(axis.at(axis.low) - 3, y + 4, "◂", 12, svg.INK, "middle")
    if high > axis.high:
        sheet.text(axis.at(axis.high) + 3, y + 4, "▸", 12, svg.INK, "middle")
    if axis.low <= gz <= axis.high:
        sheet.dot(axis.at(gz), y, 5, svg.INK)
    words = f"{fixed(gz, 2)} [{fixed(low, 2)}, {fixed(high, 2)}]"
    sheet.text(EFFECTS_RIGHT + 14, y + 4, words, 10, svg.FAINT)
