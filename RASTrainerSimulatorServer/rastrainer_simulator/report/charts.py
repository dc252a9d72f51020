"""The charts of reports, drawn by Matplotlib as SVG: one style, the same bytes for the same data.

Lengths are in px of the chart's own size, which the page scales.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from markupsafe import Markup

from rastrainer.number_text import fixed, significant
from rastrainer.registration.distributions import Proportion
from rastrainer.study.outcomes import mode_title, short_mode_title
from rastrainer.study.tre_calibration import CalibrationPoint
from rastrainer_simulator.report.comparisons import ModeComparison

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, FAINT, GRID, OFF = "#1f2933", "#6b7785", "#e3e7ec", "#b3261e"
"""`OFF` is the rim of points outside their intervals."""
MODE_COLORS = {"desktop": "#0b6fa4", "hmd": "#d1661b"}
"""The paper's two, distinguishable for the color-blind."""
OTHER_COLORS = ("#3d7f5f", "#8a4f9e", "#b3972c", "#5a6672")
FONT, MEASURED_FONT = "'Helvetica Neue', Helvetica, Arial, sans-serif", "'DejaVu Sans'"
"""The font of pages, and the font of Matplotlib, which measures texts with it."""
STYLE = Path(__file__).with_name("charts.mplstyle")
SVG = "{http://www.w3.org/2000/svg}"
LEFT_OUT = {f"{SVG}style", f"{SVG}metadata"}
"""The style would hold for the whole page, the metadata have dates."""
SHAPES = {f"{SVG}use", f"{SVG}path"}
LINK = "{http://www.w3.org/1999/xlink}href"
PX_PER_INCH = 72
"""As Matplotlib counts in SVG files."""
HALF_WIDTH, WIDTH = 330, 680
"""Width of charts side by side, and of a chart alone."""


def mode_color(mode: str, index: int = 0) -> str:
    return MODE_COLORS.get(mode, OTHER_COLORS[index % len(OTHER_COLORS)])


@dataclass
class Chart:
    """A drawing under way; by groups of dots, the `titles` that show under the mouse."""

    figure: Figure
    axes: Axes
    description: str
    titles: dict[str, Sequence[str]] = field(default_factory=dict)

    def dots(
        self,
        xs: Sequence[float] | np.ndarray,
        ys: Sequence[float] | np.ndarray,
        color: str,
        radius: float,
        opacity: float = 1.0,
        titles: Sequence[str] = (),
    ) -> None:
        name = f"dots-{len(self.titles)}"
        self.titles[name] = titles
        self.axes.scatter(
            xs,
            ys,
            s=(2 * radius) ** 2,
            color=color,
            alpha=opacity,
            edgecolors="white",
            linewidths=0.7,
            zorder=3,
            clip_on=False,
            gid=name,
        )

    def legend(self, x: float) -> None:
        """Write the legend in a row below the title; `x` is a share of the width."""
        height = self.figure.get_figheight() * PX_PER_INCH
        self.figure.legend(
            loc="upper left", bbox_to_anchor=(x, 1 - 24 / height), ncols=8, fontsize=11
        )

    def svg(self) -> Markup:
        """Return the drawing without what differs from run to run, or holds for a whole page."""
        written = io.BytesIO()
        with warnings.catch_warnings():
            # Readers have fonts for letters that this one lacks.
            warnings.filterwarnings("ignore", "Glyph .* missing from font")
            self.figure.savefig(written, format="svg", transparent=True)
        root = ElementTree.fromstring(written.getvalue())
        for name, titles in self.titles.items():
            group = next(each for each in root.iter() if each.get("id") == name)
            outside = (part for part in group if part.tag != f"{SVG}defs")
            shapes = (each for part in outside for each in part.iter() if each.tag in SHAPES)
            for shape, title in zip(shapes, titles, strict=False):
                ElementTree.SubElement(shape, f"{SVG}title").text = title
        for parent in list(root.iter()):
            for child in [each for each in parent if each.tag in LEFT_OUT]:
                parent.remove(child)
        for each in root.iter():
            # Groups have the same names in every chart; shapes have names of their content.
            if each.tag == f"{SVG}g":
                each.attrib.pop("id", None)
            if LINK in each.attrib:
                each.set("href", each.attrib.pop(LINK))
            if "style" in each.attrib:
                each.set("style", each.get("style", "").replace(MEASURED_FONT, FONT))
        for name in ("width", "height", "version"):
            root.attrib.pop(name, None)
        root.set("role", "img")
        root.set("aria-label", self.description)
        root.set("stroke-linejoin", "round")
        ElementTree.register_namespace("", SVG.strip("{}"))
        return Markup(ElementTree.tostring(root, encoding="unicode"))


@contextmanager
def drawn(
    width: float,
    height: float,
    box: tuple[float, float, float, float],
    title: str,
    description: str = "",
) -> Iterator[Chart]:
    """Make a chart in the report's style; its description, by default the title, is for the blind.

    The box is left, right, top and bottom of the axes, from the upper left corner.
    """
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    left, right, top, bottom = box
    with rc_context(fname=STYLE):
        figure = Figure(figsize=(width / PX_PER_INCH, height / PX_PER_INCH), dpi=PX_PER_INCH)
        axes = figure.add_axes(
            (left / width, 1 - bottom / height, (right - left) / width, (bottom - top) / height)
        )
        axes.locator_params(steps=[1, 2, 5, 10], nbins=5)
        figure.text(
            10 / width, 1 - 16 / height, title, fontsize=12.5, fontweight="bold", va="baseline"
        )
        yield Chart(figure, axes, description or title)


Series = tuple[str, str, Sequence[Sequence[float]]]
"""Name, color, and the values of each group."""
SCATTER = np.arange(300) * 0.618 % 1.0 - 0.5
"""Offsets that keep neighboring dots apart, always the same."""
MAX_DOTS = 40
"""A bar with more trials shows as many quantiles of them."""


def grouped_bars(
    heading: str, groups: Sequence[str], series: Sequence[Series], by: str = "task and mode"
) -> Markup:
    """Return the chart; bars are means, whiskers one standard deviation (n − 1)."""
    with drawn(WIDTH, 232, (48, 672, 50, 188), heading, f"{heading} by {by}") as chart:
        axes = chart.axes
        width = min(46.0 * len(groups) / (672 - 48), 0.72 / len(series))
        for index, (name, color, values) in enumerate(series):
            places = np.arange(len(groups)) + (index - (len(series) - 1) / 2) * width
            means = [float(np.mean(own)) if own else np.nan for own in values]
            axes.bar(places, means, 0.88 * width, color=color, alpha=0.32, label=name)
            for place, mean, own in zip(places, means, values, strict=True):
                if not own:
                    continue
                axes.hlines(mean, place - 0.44 * width, place + 0.44 * width, color, linewidth=2.2)
                if len(own) > 1:
                    sd = float(np.std(own, ddof=1))
                    axes.vlines(place, mean - sd, mean + sd, color, linewidth=1.2)
                shown = _thinned(own, MAX_DOTS)
                chart.dots(place + 0.48 * width * SCATTER[: len(shown)], shown, color, 2.4, 0.9)
        axes.set_xlim(-0.5, len(groups) - 0.5)
        axes.set_xticks(range(len(groups)), groups, fontsize=11, color=INK)
        chart.legend(48 / WIDTH)
        note = "bar: mean; whisker: ± 1 SD; dot: one trial"
        chart.figure.text(48 / WIDTH, 6 / 232, note, fontsize=9.5, color=FAINT)
        return chart.svg()


def _thinned(values: Sequence[float] | np.ndarray, most: int) -> np.ndarray:
    return np.asarray(
        values if len(values) <= most else np.quantile(values, np.linspace(0, 1, most))
    )


LANE_HEIGHT, MAX_LANE_DOTS = 74, len(SCATTER)


def distribution(heading: str, lanes: Sequence[tuple[str, str, Sequence[float]]]) -> Markup:
    height = 54 + LANE_HEIGHT * len(lanes)
    box = (66, 318, 28, height - 24)
    with drawn(HALF_WIDTH, height, box, heading, f"Distribution of {heading}") as chart:
        axes = chart.axes
        axes.grid(False, axis="y")
        axes.grid(True, axis="x")
        for place, (_name, color, values) in enumerate(lanes):
            ordered = np.sort(np.asarray(values, dtype=float))
            shown = _thinned(ordered, MAX_LANE_DOTS)
            radius = 3.2 if len(shown) <= 60 else 1.8
            heights = place - 0.14 + 0.42 * SCATTER[: len(shown)]
            chart.dots(shown, heights, color, radius, 0.75)
            low, middle, high = np.quantile(ordered, [0.25, 0.5, 0.75])
            axes.hlines(place + 0.27, ordered[0], ordered[-1], color, linewidth=1.2)
            axes.hlines(place + 0.27, low, high, color, linewidth=8, alpha=0.35)
            axes.vlines(middle, place + 0.17, place + 0.37, color, linewidth=2.5)
        axes.set_ylim(len(lanes) - 0.5, -0.5)
        names = [name for name, _color, _values in lanes]
        axes.set_yticks(range(len(lanes)), names, fontsize=11, color=INK)
        return chart.svg()


MAX_NAMED_TRAINEES = 24
"""Dots of more trainees hide their curves."""


def learning_curves(
    heading: str,
    color: str,
    trainees: Mapping[str, Sequence[tuple[float, float]]],
    x_title: str,
    curve: Sequence[tuple[float, float]] = (),
    span: Sequence[float] = (),
) -> Markup:
    """Return the chart of every trainee's points (trial number, value), with a curve of all.

    Without a fitted curve, the means are connected. The axis includes the values of `span`, which
    makes charts comparable.
    """
    points = [point for own in trainees.values() for point in own]
    numbers = sorted({x for x, _ in points})
    means = [(x, float(np.mean([y for n, y in points if n == x]))) for x in numbers]
    opacity = 0.55 if len(trainees) <= 12 else max(0.08, 6 / len(trainees))
    with drawn(HALF_WIDTH, 232, (46, 318, 32, 190), heading) as chart:
        axes = chart.axes
        for name, own in trainees.items():
            xs, ys = zip(*own, strict=True)
            axes.plot(xs, ys, color=color, linewidth=1.2, alpha=opacity)
            if len(trainees) <= MAX_NAMED_TRAINEES:
                titles = [f"{name}: {significant(y, 4)}" for y in ys]
                chart.dots(xs, ys, color, 2.6, 0.8, titles)
        axes.plot(*zip(*(curve or means), strict=True), color=INK, linewidth=2.4, zorder=4)
        axes.update_datalim([(numbers[0], value) for value in span])
        axes.autoscale_view(scalex=False)
        if len(numbers) <= 12:
            axes.set_xticks(numbers)
        axes.set_xlim(numbers[0] - 0.35, numbers[-1] + 0.35)
        axes.set_xlabel(x_title)
        return chart.svg()


FIRST, SECOND, DIFFERENCE = 0.0, 1.0, 268
"""Places of the modes on their axis, and of the axis of their difference."""


def paired_lines(comparison: ModeComparison) -> Markup:
    outcome, result = comparison.outcome, comparison.result
    described = f"{outcome.title} of every trainee in both modes"
    few = len(comparison.trainees) <= 12
    opacity = 0.75 if few else max(0.12, 8 / len(comparison.trainees))
    modes = (comparison.first, comparison.second)
    both = (comparison.first_means, comparison.second_means)
    with drawn(HALF_WIDTH, 250, (44, 198, 40, 212), outcome.heading, described) as chart:
        axes = chart.axes
        axes.plot([FIRST, SECOND], both, color=FAINT, linewidth=1.1, alpha=opacity)
        for index, (place, values) in enumerate(zip((FIRST, SECOND), both, strict=True)):
            titles = [
                f"{trainee}: {significant(value, 4)}"
                for trainee, value in zip(comparison.trainees, values, strict=True)
            ]
            places, color = np.full(len(values), place), mode_color(modes[index], index)
            chart.dots(places, values, color, 3.4, max(opacity, 0.5), titles)
        means = [float(values.mean()) for values in both]
        axes.plot([FIRST, SECOND], means, color=INK, linewidth=2.6, zorder=4)
        axes.set_xlim(-0.4, 1.24)
        axes.set_xticks([FIRST, SECOND], map(short_mode_title, modes), fontsize=11, color=INK)
        if result is None:
            x, y = DIFFERENCE / HALF_WIDTH, 0.5
            chart.figure.text(x, y, "no test", color=FAINT, ha="center")
        else:
            _difference(chart, result.difference.value, result.difference.interval)
        return chart.svg()


def _difference(chart: Chart, difference: float, interval: tuple[float, float]) -> None:
    """Draw a difference with its interval on a second axis, to the right of the others."""
    low, high = interval
    box = chart.axes.get_position()
    place = ((DIFFERENCE - 24) / HALF_WIDTH, box.y0, 48 / HALF_WIDTH, box.height)
    right = chart.figure.add_axes(place)
    right.locator_params(axis="y", steps=[1, 2, 5, 10], nbins=4)
    right.yaxis.tick_right()
    right.axhline(0.0, color="#9aa5b1", linewidth=1)
    reach = [[difference - low], [high - difference]]
    bar: dict[str, Any] = {"fmt": "o", "color": INK, "markersize": 9, "capsize": 6}
    right.errorbar([0.0], [difference], reach, elinewidth=2, capthick=2, **bar)
    right.update_datalim([(0.0, value) for value in (0.0, 1.1 * low, 1.1 * high)])
    right.autoscale_view()
    right.set_xlim(-1.0, 1.0)
    right.set_xticks([0.0], ["difference"], fontsize=11, color=INK)
    right.set_xlabel("mean, 95 % interval", fontsize=9)


MAX_EFFECT_SIZE = 6.0


def effect_sizes(comparisons: Sequence[ModeComparison]) -> Markup:
    """Return the chart; intervals beyond the axis end in an arrow."""
    shown = [
        (comparison, result.effect.value, result.effect.interval)
        for comparison in comparisons
        if (result := comparison.result) is not None and result.effect is not None
    ]
    reach = max([1.0, *(abs(end) for _comparison, _gz, interval in shown for end in interval)])
    reach = min(MAX_EFFECT_SIZE, reach * 1.05)
    height = 76 + 27 * len(shown)
    box = (226, 536, 24, height - 44)
    with drawn(WIDTH, height, box, "", "Effect sizes with their intervals") as chart:
        axes = chart.axes
        axes.grid(False, axis="y")
        axes.grid(True, axis="x")
        axes.axvline(0.0, color="#7b8794", linewidth=1)
        for row, (_comparison, gz, (low, high)) in enumerate(shown):
            axes.hlines(row, max(low, -reach), min(high, reach), INK, linewidth=2)
            ends = [(-reach, "<")] * (low < -reach) + [(reach, ">")] * (high > reach)
            for end, arrow in ends:
                axes.plot([end], [row], arrow, color=INK, markersize=6, clip_on=False)
            if abs(gz) <= reach:
                chart.dots([gz], [row], INK, 5)
            words = f"{fixed(gz, 2)} [{fixed(low, 2)}, {fixed(high, 2)}]"
            axes.text(reach * 1.08, row, words, color=FAINT, va="center")
        axes.set_xlim(-reach, reach)
        axes.locator_params(axis="x", nbins=9)
        axes.set_ylim(len(shown) - 0.4, -0.7)
        titles = [comparison.outcome.title for comparison, _gz, _interval in shown]
        axes.set_yticks(range(len(shown)), titles, fontsize=11, color=INK)
        axes.set_xlabel("Hedges' g_z with 95 % interval")
        first, second = (mode_title(mode) for mode in (shown[0][0].first, shown[0][0].second))
        above: dict[str, Any] = {
            "color": FAINT,
            "xycoords": ("data", "axes fraction"),
            "annotation_clip": False,
        }
        axes.annotate(f"← higher with {first}", (-0.05 * reach, 1.03), ha="right", **above)
        axes.annotate(f"higher with {second} →", (0.05 * reach, 1.03), ha="left", **above)
        return chart.svg()


@contextmanager
def _scatter(
    title: str, x_title: str, y_title: str, farthest: float, highest: float
) -> Iterator[Chart]:
    """Make a chart whose axes start at 0, with the line on which both are equal."""
    with drawn(660, 360, (60, 640, 56, 306), title) as chart:
        axes = chart.axes
        axes.update_datalim([(0.0, 0.0), (farthest, highest)])
        axes.autoscale_view()
        axes.autoscale(False)
        axes.locator_params(axis="x", nbins=8)
        axes.tick_params(axis="x", length=4)
        axes.set_xlabel(x_title, fontsize=11, color=INK)
        axes.set_ylabel(y_title, fontsize=11, color=INK, labelpad=8)
        yield chart


def _equal(chart: Chart, label: str) -> None:
    end = min(chart.axes.get_xlim()[1], chart.axes.get_ylim()[1])
    chart.axes.plot([0, end], [0, end], "--", color=INK, linewidth=1.3, label=label)
    chart.legend(60 / 660)


def calibration_chart(
    points: Sequence[CalibrationPoint], colors: Mapping[str, tuple[str, str]]
) -> Markup:
    """Return true against expected errors with their intervals; `colors` have name and color."""
    few = len(points) <= 120
    # Bars of many trials overlap.
    opacity = max(0.05, min(0.55, 14 / len(points)))
    with _scatter(
        "True against expected target error (mm)",
        "expected TRE (mm)",
        "true TRE (mm)",
        max(point.expected_mm for point in points),
        max(max(point.true_mm, point.interval_mm[1]) for point in points),
    ) as chart:
        for mode, (name, color) in colors.items():
            own = [point for point in points if point.mode == mode]
            expected = np.array([point.expected_mm for point in own])
            true = np.array([point.true_mm for point in own])
            ends = np.array([point.interval_mm for point in own])
            middles = ends.mean(axis=1)
            reach = np.abs(ends.T - middles)
            bars: dict[str, Any] = {"fmt": "none", "ecolor": color, "alpha": opacity}
            chart.axes.errorbar(expected, middles, reach, elinewidth=1.6, capsize=2.5, **bars)
            off = np.array([not point.is_inside for point in own])
            radius = 3.6 if few else 2.4
            chart.dots(expected[off], true[off], OFF, radius + 2.4)
            titles = [
                f"{point.trainee}, {point.task}: true {fixed(point.true_mm, 2)} mm, expected "
                f"{fixed(point.expected_mm, 2)} mm"
                for point in own
            ]
            chart.dots(expected, true, color, radius, 0.85, titles)
            chart.axes.scatter([], [], color=color, s=50, label=name)
        rim: dict[str, Any] = {"facecolors": GRID, "edgecolors": OFF, "linewidths": 2.4, "s": 50}
        chart.axes.scatter([], [], label="outside of its interval", **rim)
        chart.axes.plot([], [], "|", color=FAINT, markersize=14, label="95 % interval")
        _equal(chart, "true = expected")
        return chart.svg()


def reliability_chart(shares: Mapping[int, Proportion]) -> Markup:
    """Return how often decisions were right, by the stated probability in percent."""
    stated = sorted(shares)
    right = np.array([100 * shares[each].share for each in stated])
    ends = 100 * np.array([shares[each].interval for each in stated]).T
    title = "Right decisions by stated confidence, %"
    with drawn(WIDTH, 232, (48, 672, 32, 178), title) as chart:
        axes = chart.axes
        axes.plot([50, 100], [50, 100], "--", color=FAINT, linewidth=1.3)
        axes.vlines(stated, ends[0], ends[1], INK, linewidth=1.6)
        counts = [f"{shares[each].count} of {shares[each].total}" for each in stated]
        titles = [f"stated {each} %: right in {n}" for each, n in zip(stated, counts, strict=True)]
        chart.dots(stated, right, INK, 4.2, titles=titles)
        axes.set_xlim(46, 104)
        axes.set_ylim(0, 104)
        axes.set_xticks(stated, [f"{each}\n({shares[each].total})" for each in stated])
        axes.set_xlabel("stated (number of cases)")
        return chart.svg()


def split_chart(kinds: Mapping[tuple[str, str], tuple[np.ndarray, np.ndarray]]) -> Markup:
    """Return both parts of the target point errors: name and color → by registration, by hand."""
    largest = max(float(values.max()) for both in kinds.values() for values in both)
    few = sum(len(both[0]) for both in kinds.values()) <= 150
    with _scatter(
        "What caused the target point error (mm)",
        "by the hand (mm)",
        "by the registration (mm)",
        largest,
        largest,
    ) as chart:
        for (name, color), (by_registration, by_hand) in kinds.items():
            chart.dots(by_hand, by_registration, color, 3.4 if few else 2.2, 0.75)
            chart.axes.scatter([], [], color=color, s=50, label=name)
        _equal(chart, "both parts equal")
        return chart.svg()
