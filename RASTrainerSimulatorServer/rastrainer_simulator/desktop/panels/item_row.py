"""What a menu's column shows: a row for each kind of item, and the scores so far as bars."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.commands import deflection
from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import Color
from rastrainer_simulator.presentation.screen import ItemKind, MenuItem, ScoreTrend, Tone

_VALUE_SHARE = 0.52


@dataclass(frozen=True)
class Look:
    """How a row stands out: by the gamepad's focus, or by the mouse over it."""

    has_focus: bool
    is_hovered: bool


def draw_item(canvas: Canvas, item: MenuItem, look: Look, brush: Brush, row: Box) -> None:
    """Draw an item into its row."""
    radius = brush.px(theme.RADIUS)
    canvas.box(row, _ground(item, look), radius)
    if look.has_focus:
        canvas.frame(row, theme.ACCENT_EDGE, radius, brush.px(3))
    color = text_color(item, look)
    pad = brush.px(theme.PAD)
    style = theme.STRONG if look.has_focus or item.kind is ItemKind.BUTTON else theme.BODY
    top = row.top + (row.height - brush.line_height(style)) // 2
    has_value = item.kind is not ItemKind.BUTTON or bool(item.value)
    free = row.width - 3 * pad - brush.width(item.label, style)
    value_width = _value_width(row, free, _needed(item, brush))
    room = row.width - 2 * pad - (value_width if has_value else 0)
    brush.write(canvas, brush.fit(item.label, style, room), style, color, row.left + pad, top)
    if has_value:
        left = row.left + row.width - pad - value_width
        place = Box(left, row.top, value_width, row.height)
        _DRAW_VALUE[item.kind](canvas, item, look, brush, place, color)


def fits(item: MenuItem, brush: Brush, width: int) -> bool:
    """Return whether a row of that width shows label and value whole, with or without the focus."""
    if not item.value:
        return brush.width(item.label, theme.STRONG) + 2 * brush.px(theme.PAD) <= width
    pads = 3 * brush.px(theme.PAD)
    return brush.width(item.label, theme.STRONG) + _needed(item, brush) + pads <= width


def text_color(item: MenuItem, look: Look) -> Color:
    """Return the color of an item's label: one that cannot be chosen is readable in the focus."""
    if item.is_enabled:
        return theme.TEXT
    return theme.TEXT_SOFT if look.has_focus else theme.TEXT_PALE


def _ground(item: MenuItem, look: Look) -> Color:
    if look.has_focus:
        return theme.ACCENT if item.is_enabled else theme.ROW_HOVER
    return theme.ROW_HOVER if look.is_hovered and item.is_enabled else theme.ROW


def _needed(item: MenuItem, brush: Brush) -> int:
    between = 7 * theme.STEP if item.kind is ItemKind.CHOICE else 0
    return brush.width(item.value, theme.STRONG) + brush.px(between)


def _value_width(row: Box, free: int, needed: int) -> int:
    """Return the width of a value: its share of the row, more or less where either is clipped."""
    share = round(_VALUE_SHARE * row.width)
    return share if needed > free else max(needed, min(share, free))


def _draw_plain(
    canvas: Canvas, item: MenuItem, look: Look, brush: Brush, place: Box, color: Color
) -> None:
    text = brush.fit(item.value, theme.BODY, place.width)
    left = place.left + place.width - brush.width(text, theme.BODY)
    soft = color if look.has_focus or not item.is_enabled else theme.TEXT_SOFT
    brush.write(canvas, text, theme.BODY, soft, left, _text_top(brush, place))


def _draw_choice(
    canvas: Canvas, item: MenuItem, look: Look, brush: Brush, place: Box, color: Color
) -> None:
    """Draw the chosen option between two arrow heads."""
    reach = brush.px(theme.STEP)
    middle = place.top + place.height / 2
    right = place.left + place.width
    arrows = color if look.has_focus else theme.TEXT_SOFT if item.is_enabled else color
    for x, side in ((place.left + reach, 1), (right - reach, -1)):
        points = [(x + side * reach / 2, middle - reach), (x - side * reach / 2, middle)]
        canvas.stroke([*points, (x + side * reach / 2, middle + reach)], brush.px(3), arrows)
    text = brush.fit(item.value, theme.STRONG, place.width - 6 * reach)
    left = place.left + (place.width - brush.width(text, theme.STRONG)) // 2
    brush.write(canvas, text, theme.STRONG, color, left, _text_top(brush, place))


def _draw_text(
    canvas: Canvas, item: MenuItem, look: Look, brush: Brush, place: Box, color: Color
) -> None:
    """Draw a sunk field with what was typed, its end in sight, and a caret after it."""
    field = Box(place.left, place.top + brush.px(9), place.width, place.height - 2 * brush.px(9))
    canvas.box(field, theme.FIELD, brush.px(theme.STEP))
    canvas.frame(
        field,
        theme.ACCENT_EDGE if look.has_focus else theme.EDGE,
        brush.px(theme.STEP),
        brush.px(1.5),
    )
    pad = brush.px(theme.GAP)
    text = item.value
    while brush.width(text, theme.BODY) > field.width - 2 * pad - brush.px(4):
        text = text[1:]
    width = brush.write(canvas, text, theme.BODY, color, field.left + pad, _text_top(brush, place))
    if look.has_focus:
        x = field.left + pad + width + brush.px(4)
        caret = Box(x, field.top + brush.px(9), brush.px(2.5), field.height - 2 * brush.px(9))
        canvas.box(caret, theme.TEXT)


def _draw_axis(
    canvas: Canvas, item: MenuItem, look: Look, brush: Brush, place: Box, color: Color
) -> None:
    """Draw a position between −1 and 1 as a bar from the middle of a track."""
    del look
    height = brush.px(theme.STEP + 2)
    top = place.top + (place.height - height) // 2
    canvas.box(Box(place.left, top, place.width, height), theme.FIELD, height / 2)
    middle = place.left + place.width // 2
    try:
        position = deflection(float(item.value.replace("−", "-")))
    except ValueError:
        position = 0.0
    length = round(abs(position) * place.width / 2)
    bar = Box(middle if position > 0 else middle - length, top, max(1, length), height)
    canvas.box(bar, theme.TONES[Tone.GOOD], height / 2)
    tick = brush.px(2)
    canvas.box(Box(middle - tick // 2, top - height, tick, 3 * height), color)


def _text_top(brush: Brush, place: Box) -> int:
    return place.top + (place.height - brush.line_height(theme.BODY)) // 2


_DRAW_VALUE = {
    ItemKind.BUTTON: _draw_plain,
    ItemKind.CHOICE: _draw_choice,
    ItemKind.TEXT: _draw_text,
    ItemKind.AXIS: _draw_axis,
}


_PLOT_HEIGHT = 0.55
"""Height of a plot as a share of its column's width."""
_BROADEST_BAR = 8 * theme.STEP
_BAR_SHARE = 0.72
"""Width of a bar as a share of the distance to the next one."""


def trend_height(brush: Brush, width: int) -> int:
    """Return how many pixels a plot of this width is high."""
    return brush.line_height(theme.SMALL_STRONG) + round(_PLOT_HEIGHT * width)


def draw_trend(canvas: Canvas, place: Box, trend: ScoreTrend, brush: Brush) -> None:
    """Draw the plot at the top of a place: a full bar is a score of 100."""
    height = round(_PLOT_HEIGHT * place.width)
    bottom = place.top + trend_height(brush, place.width)
    step = min(place.width / len(trend.scores), brush.px(_BROADEST_BAR))
    bars = []
    for number, score in enumerate(trend.scores):
        high = max(brush.px(2), round(height * score / 100.0))
        left = place.left + round(number * step)
        bars.append(Box(left, bottom - high, max(1, round(_BAR_SHARE * step)), high))
        has_passed = trend.mark > 0.0 and score >= trend.mark
        color = theme.TONES[Tone.GOOD if has_passed else Tone.PLAIN]
        canvas.box(bars[-1], color, brush.px(4))
    rule = brush.px(2)
    canvas.box(Box(place.left, bottom, place.width, rule), theme.CAP_EDGE)
    if trend.mark > 0.0:
        level = bottom - round(height * trend.mark / 100.0)
        canvas.box(Box(place.left, level, place.width, rule), theme.TARGET)
    _write_over(canvas, bars[-1], place, f"{trend.scores[-1]:.0f}", brush)


def _write_over(canvas: Canvas, bar: Box, place: Box, text: str, brush: Brush) -> None:
    """Write a number above a bar, within the plot."""
    width = brush.width(text, theme.SMALL_STRONG)
    left = max(place.left, bar.left + (bar.width - width) // 2)
    top = bar.top - brush.line_height(theme.SMALL_STRONG)
    brush.write(canvas, text, theme.SMALL_STRONG, theme.TEXT, left, top)
