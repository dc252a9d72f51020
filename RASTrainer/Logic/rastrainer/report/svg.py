"""Charts as SVG: a sheet with shapes, and axes with round numbers."""

from __future__ import annotations

import html
import math
from collections.abc import Sequence
from dataclasses import dataclass

INK = "#1f2933"
FAINT = "#6b7785"
GRID = "#e3e7ec"
FONT = "font-family:'Helvetica Neue',Helvetica,Arial,sans-serif"
MODE_COLORS = {"desktop": "#0b6fa4", "hmd": "#d1661b"}
OTHER_COLORS = ("#3d7f5f", "#8a4f9e", "#b3972c", "#5a6672")


def mode_color(mode: str, index: int = 0) -> str:
    """Return the color of a mode; the paper's two are distinguishable for the color-blind."""
    return MODE_COLORS.get(mode, OTHER_COLORS[index % len(OTHER_COLORS)])


class Sheet:
    """Collects shapes; positions are in px from the upper left corner."""

    def __init__(
        self, width: float, height: float, title: str, description: str = "", left: float = 10
    ) -> None:
        """Write the title above; the description, by default the title, is read to the blind."""
        self.width, self.height = width, height
        self._description = description or title
        self._parts: list[str] = []
        if title:
            self.text(left, 16, title, 12.5, weight="600")

    def line(
        self,
        x1: float,
        y1: float,
        x2: float,
        y2: float,
        color: str = INK,
        width: float = 1.0,
        dash: str = "",
    ) -> None:
        dashed = f' stroke-dasharray="{dash}"' if dash else ""
        self._parts.append(
            f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{color}" '
            f'stroke-width="{width:g}"{dashed}/>'
        )

    def polyline(
        self, points: Sequence[tuple[float, float]], color: str, width: float, opacity: float = 1.0
    ) -> None:
        path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
        self._parts.append(
            f'<polyline points="{path}" fill="none" stroke="{color}" stroke-width="{width:g}" '
            f'stroke-linejoin="round" stroke-opacity="{opacity:g}"/>'
        )

    def rect(
        self, x: float, y: float, width: float, height: float, color: str, opacity: float = 1.0
    ) -> None:
        self._parts.append(
            f'<rect x="{x:.1f}" y="{y:.1f}" width="{max(width, 0):.1f}" '
            f'height="{max(height, 0):.1f}" fill="{color}" fill-opacity="{opacity:g}"/>'
        )

    def dot(
        self, x: float, y: float, radius: float, color: str, opacity: float = 1.0, title: str = ""
    ) -> None:
        """Draw a dot with a thin white rim; `title` shows under the mouse."""
        inside = f"<title>{html.escape(title)}</title>" if title else ""
        self._parts.append(
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius:g}" fill="{color}" '
            f'fill-opacity="{opacity:g}" stroke="#fff" stroke-width="0.7">{inside}</circle>'
        )

    def text(
        self,
        x: float,
        y: float,
        text: str,
        size: float = 11,
        color: str = INK,
        anchor: str = "start",
        weight: str = "normal",
        turn: float = 0.0,
    ) -> None:
        """Write a line of text; `y` is its baseline."""
        turned = f' transform="rotate({turn:g} {x:.1f} {y:.1f})"' if turn else ""
        self._parts.append(
            f'<text x="{x:.1f}" y="{y:.1f}" font-size="{size:g}" fill="{color}" '
            f'text-anchor="{anchor}" font-weight="{weight}"{turned}>{html.escape(text)}</text>'
        )

    def svg(self) -> str:
        label = html.escape(self._description, quote=True)
        return (
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width:g} {self.height:g}" '
            f'role="img" aria-label="{label}" style="{FONT}">{"".join(self._parts)}</svg>'
        )


@dataclass(frozen=True)
class Axis:
    """A linear map from values to px; `start` may be above or below `end`."""

    low: float
    high: float
    start: float
    end: float

    def at(self, value: float) -> float:
        return self.start + (value - self.low) / (self.high - self.low) * (self.end - self.start)

    def ticks(self, count: int = 5) -> list[float]:
        """Return round values within the axis."""
        step = round_step((self.high - self.low) / count)
        first = math.ceil(self.low / step - 1e-9)
        last = math.floor(self.high / step + 1e-9)
        return [round(index * step, 10) for index in range(first, last + 1)]


def axis_over(values: Sequence[float], start: float, end: float, from_zero: bool = False) -> Axis:
    """Return an axis with round ends over all values."""
    low, high = min(values), max(values)
    if from_zero:
        low, high = min(0.0, low), max(0.0, high)
    if low == high:
        low, high = low - 0.5 * abs(low or 1), high + 0.5 * abs(high or 1)
    step = round_step((high - low) / 5)
    return Axis(
        math.floor(low / step + 1e-9) * step, math.ceil(high / step - 1e-9) * step, start, end
    )


def round_step(about: float) -> float:
    """Return 1, 2 or 5 times a power of ten near a step."""
    power = 10.0 ** math.floor(math.log10(about))
    return next(power * factor for factor in (1, 2, 5, 10) if power * factor >= about * 0.999)


def number(value: float) -> str:
    """Return a tick's number with a true minus sign."""
    return f"{value:g}".replace("-", "−")


def x_grid(
    sheet: Sheet, axis: Axis, top: float, bottom: float, count: int = 5, zero: str = GRID
) -> None:
    """Draw grid lines and numbers of a horizontal axis; `zero` is the color of the line at 0."""
    for tick in axis.ticks(count):
        x = axis.at(tick)
        sheet.line(x, top, x, bottom, zero if tick == 0 else GRID)
        sheet.text(x, bottom + 14, number(tick), 10, FAINT, "middle")


def y_grid(sheet: Sheet, axis: Axis, left: float, right: float) -> None:
    """Draw grid lines and numbers of a vertical axis."""
    for tick in axis.ticks():
        y = axis.at(tick)
        sheet.line(left, y, right, y, "#9aa5b1" if tick == 0 else GRID, 1)
        sheet.text(left - 6, y + 3.5, number(tick), 10, FAINT, "end")


SCATTER_WIDTH, SCATTER_HEIGHT = 660, 360
SCATTER_LEFT, SCATTER_RIGHT, SCATTER_TOP, SCATTER_BOTTOM = 52, 640, 52, 306


def scatter_sheet(
    title: str, x_title: str, y_title: str, farthest: float, highest: float
) -> tuple[Sheet, Axis, Axis]:
    """Return a sheet for points, with the axes along and up, and the line on which both are equal.

    Both axes start at 0 and reach `farthest` and `highest`; between title and axes there is room
    for a legend.
    """
    sheet = Sheet(SCATTER_WIDTH, SCATTER_HEIGHT, title)
    along = axis_over([0.0, farthest], SCATTER_LEFT, SCATTER_RIGHT, from_zero=True)
    up = axis_over([0.0, highest], SCATTER_BOTTOM, SCATTER_TOP, from_zero=True)
    y_grid(sheet, up, SCATTER_LEFT, SCATTER_RIGHT)
    for tick in along.ticks(8):
        x = along.at(tick)
        sheet.line(x, SCATTER_BOTTOM, x, SCATTER_BOTTOM + 4, FAINT)
        sheet.text(x, SCATTER_BOTTOM + 17, number(tick), 10, FAINT, "middle")
    end = min(along.high, up.high)
    sheet.line(along.at(0.0), up.at(0.0), along.at(end), up.at(end), INK, 1.3, "5 4")
    middle = (SCATTER_LEFT + SCATTER_RIGHT) / 2, (SCATTER_TOP + SCATTER_BOTTOM) / 2
    sheet.text(middle[0], SCATTER_HEIGHT - 12, x_title, 11, INK, "middle")
    sheet.text(16, middle[1], y_title, 11, INK, "middle", turn=-90)
    return sheet, along, up


def legend(sheet: Sheet, x: float, y: float, names: Sequence[tuple[str, str]]) -> None:
    """Draw names with their colors in a row."""
    for name, color in names:
        sheet.rect(x, y - 9, 10, 10, color)
        sheet.text(x + 15, y, name, 11)
        x += 34 + 6.3 * len(name)
