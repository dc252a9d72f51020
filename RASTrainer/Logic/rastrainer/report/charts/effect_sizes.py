"""Effect sizes of several outcomes on one axis, each with its interval."""

from __future__ import annotations

from collections.abc import Sequence

from rastrainer.number_text import fixed
from rastrainer.report.charts.svg import FAINT, INK, Axis, Sheet, number
from rastrainer.report.comparisons import ModeComparison
from rastrainer.report.outcomes import mode_title

WIDTH, ROW = 680, 27
LEFT, RIGHT = 226, 536
FARTHEST = 6.0


def effect_sizes(comparisons: Sequence[ModeComparison]) -> str:
    """Return the chart; intervals that leave the axis end in an arrow."""
    shown = [one for one in comparisons if one.result is not None and one.result.gz_interval]
    reach = max([1.0, *(abs(end) for comparison in shown for end in comparison.result.gz_interval)])
    reach = min(FARTHEST, reach * 1.05)
    axis = Axis(-reach, reach, LEFT, RIGHT)
    height = 64 + ROW * len(shown)
    sheet = Sheet(WIDTH, height, "Effect sizes with their intervals")
    for tick in axis.ticks(8):
        x = axis.at(tick)
        sheet.line(x, 24, x, height - 32, "#7b8794" if tick == 0 else "#e3e7ec")
        sheet.text(x, height - 18, number(tick), 10, FAINT, "middle")
    for index, comparison in enumerate(shown):
        _row(sheet, axis, 42 + ROW * index, comparison)
    if shown:
        first, second = (mode_title(mode) for mode in (shown[0].first, shown[0].second))
        sheet.text(axis.at(0) - 8, 14, f"← higher with {first}", 10, FAINT, "end")
        sheet.text(axis.at(0) + 8, 14, f"higher with {second} →", 10, FAINT)
    sheet.text(
        (LEFT + RIGHT) / 2, height - 3, "Hedges' g_z with 95 % interval", 10, FAINT, "middle"
    )
    return sheet.svg()


def _row(sheet: Sheet, axis: Axis, y: float, comparison: ModeComparison) -> None:
    result = comparison.result
    low, high = result.gz_interval
    sheet.text(LEFT - 14, y + 4, comparison.outcome.title, 11, INK, "end")
    ends = [max(low, axis.low), min(high, axis.high)]
    sheet.line(axis.at(ends[0]), y, axis.at(ends[1]), y, INK, 2)
    if low < axis.low:
        sheet.text(axis.at(axis.low) - 3, y + 4, "◂", 12, INK, "middle")
    if high > axis.high:
        sheet.text(axis.at(axis.high) + 3, y + 4, "▸", 12, INK, "middle")
    if axis.low <= result.hedges_gz <= axis.high:
        sheet.dot(axis.at(result.hedges_gz), y, 5, INK)
    words = f"{fixed(result.hedges_gz, 2)} [{fixed(low, 2)}, {fixed(high, 2)}]"
    sheet.text(RIGHT + 14, y + 4, words, 10, FAINT)
