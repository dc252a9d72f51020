"""The small panels at the edges: instruction, warnings, status and hints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import Color, TextStyle
from rastrainer_simulator.presentation.screen import Hint, ScreenMessage
from rastrainer_simulator.scene.nodes import COVERED

LEAST_TARGET_PX = 24
"""Height of what can be clicked: WCAG 2.2, 2.5.8."""


def instruction(message: ScreenMessage, brush: Brush, room: int) -> np.ndarray:
    """Return what to do now, at most `room` pixels wide; a bar in the tone's color leads it."""
    return _sentence(message, theme.HEADING, theme.GLASS, theme.TONES[message.tone], brush, room)


def warning(message: ScreenMessage, brush: Brush, room: int) -> np.ndarray:
    """Return the warnings, on a background that cannot be overlooked."""
    return _sentence(message, theme.STRONG, theme.BANNERS[message.tone], theme.TEXT, brush, room)


def status(facts: Sequence[str], brush: Brush, room: int) -> np.ndarray:
    """Return short facts, one beside the other, in as many rows as they need."""
    pad, gap = brush.px(theme.GAP), brush.px(theme.STEP)
    height = brush.line_height(theme.SMALL_STRONG) + 2 * brush.px(theme.STEP)
    places: list[Box] = []
    left = top = 0
    for fact in facts:
        width = brush.width(fact, theme.SMALL_STRONG) + 2 * pad
        if left and left + width > room:
            left, top = 0, top + height + gap
        places.append(Box(left, top, width, height))
        left += width + gap
    canvas = Canvas(max(place.left + place.width for place in places), top + height)
    for fact, place in zip(facts, places, strict=True):
        canvas.box(place, theme.GLASS, height / 2)
        inside = place.top + brush.px(theme.STEP)
        brush.write(canvas, fact, theme.SMALL_STRONG, theme.TEXT, place.left + pad, inside)
    return canvas.pixels()


def legend(text: str, brush: Brush, _room: int) -> np.ndarray:
    """Return the meaning of the paint on the skin, beside a sample of it."""
    pad, step = brush.px(theme.GAP), brush.px(theme.STEP)
    sample = brush.line_height(theme.SMALL_STRONG)
    width = sample + brush.width(text, theme.SMALL_STRONG) + 2 * pad + step
    canvas = Canvas(width, sample + 2 * step)
    canvas.box(Box(0, 0, canvas.width, canvas.height), theme.GLASS, canvas.height / 2)
    inside = Box(pad, step, sample, sample).inset(sample // 8)
    canvas.box(inside, (*COVERED.color, 1.0), step)
    brush.write(canvas, text, theme.SMALL_STRONG, theme.TEXT, pad + sample + step, step)
    return canvas.pixels()


def hints(content: tuple[Sequence[Hint], str], brush: Brush, room: int) -> np.ndarray:
    """Return controls as key caps with what they do, in as many rows as they need.

    `content` has the hints, and the item of the one under the mouse.
    """
    shown, hovered = content
    rows = _rows(shown, brush, room)
    pad, cap = brush.px(theme.STEP), _cap_height(brush)
    width = max(_hints_width(row, brush) for row in rows)
    canvas = Canvas(width, len(rows) * (cap + pad) + pad)
    ground = Box(0, 0, canvas.width, canvas.height)
    canvas.box(ground, theme.GLASS, min(canvas.height / 2, brush.px(theme.PANEL_RADIUS)))
    for hint, box in hint_boxes(shown, brush, room):
        _write_hint(canvas, hint, brush, box, bool(hovered) and hint.item == hovered)
    return canvas.pixels()


def hint_boxes(shown: Sequence[Hint], brush: Brush, room: int) -> list[tuple[Hint, Box]]:
    """Return where each hint is in the picture that `hints` makes."""
    rows = _rows(shown, brush, room)
    pad, cap = brush.px(theme.STEP), _cap_height(brush)
    width = max(_hints_width(row, brush) for row in rows)
    found = []
    for index, row in enumerate(rows):
        left = (width - _hints_width(row, brush)) // 2 + brush.px(theme.PAD)
        for hint in row:
            wide = _hint_width(hint, brush)
            found.append((hint, Box(left, pad + index * (cap + pad), wide, cap)))
            left += wide + brush.px(theme.PAD + theme.STEP)
    return found


def _rows(shown: Sequence[Hint], brush: Brush, room: int) -> list[list[Hint]]:
    rows: list[list[Hint]] = [[]]
    for hint in shown:
        if rows[-1] and _hints_width([*rows[-1], hint], brush) > room:
            rows.append([])
        rows[-1].append(hint)
    return rows


def _sentence(
    message: ScreenMessage, style: TextStyle, ground: Color, mark: Color, brush: Brush, room: int
) -> np.ndarray:
    pad_x, pad_y = brush.px(theme.MARGIN), brush.px(theme.GAP)
    bar = brush.px(theme.STEP)
    lines = brush.wrap(message.text, style, room - 2 * pad_x - bar)
    text_width = max(brush.width(line, style) for line in lines)
    line_height = brush.line_height(style)
    canvas = Canvas(text_width + 2 * pad_x + bar, len(lines) * line_height + 2 * pad_y)
    radius = brush.px(theme.PAD)
    canvas.box(Box(0, 0, canvas.width, canvas.height), ground, radius)
    inside = Box(brush.px(theme.GAP), pad_y, bar, canvas.height - 2 * pad_y)
    canvas.box(inside, mark, bar / 2)
    for index, line in enumerate(lines):
        left = bar + (canvas.width - bar - brush.width(line, style)) // 2
        brush.write(canvas, line, style, theme.TEXT, left, pad_y + index * line_height)
    return canvas.pixels()


def _cap_height(brush: Brush) -> int:
    return max(LEAST_TARGET_PX, brush.line_height(theme.SMALL) + brush.px(theme.STEP))


def _cap_width(control: str, brush: Brush) -> int:
    text = brush.width(control, theme.SMALL_STRONG)
    return max(_cap_height(brush), text + 2 * brush.px(1.5 * theme.STEP))


def _hint_width(hint: Hint, brush: Brush) -> int:
    if hint.action == hint.control:
        return _cap_width(hint.control, brush)
    action = brush.width(hint.action, theme.SMALL)
    return _cap_width(hint.control, brush) + brush.px(1.5 * theme.STEP) + action


def _hints_width(row: Sequence[Hint], brush: Brush) -> int:
    between = brush.px(theme.PAD + theme.STEP) * (len(row) - 1)
    return sum(_hint_width(hint, brush) for hint in row) + between + 2 * brush.px(theme.PAD)


def _write_hint(canvas: Canvas, hint: Hint, brush: Brush, box: Box, is_hovered: bool) -> None:
    """Draw a key cap and its action; what can be clicked is colored as buttons are.

    What is already written on the cap is not repeated.
    """
    left, top, height = box.left, box.top, box.height
    width = _cap_width(hint.control, brush)
    cap = Box(left, top, width, height)
    canvas.box(cap, theme.ACCENT if hint.item else theme.CAP, height / 4)
    edge = theme.ACCENT_EDGE if is_hovered else theme.CAP_EDGE
    canvas.frame(cap, edge, height / 4, brush.px(3 if is_hovered else 1.5))
    text = brush.width(hint.control, theme.SMALL_STRONG)
    row = top + (height - brush.line_height(theme.SMALL)) // 2
    brush.write(
        canvas, hint.control, theme.SMALL_STRONG, theme.TEXT, left + (width - text) // 2, row
    )
    if hint.action == hint.control:
        return
    beside = left + width + brush.px(1.5 * theme.STEP)
    brush.write(canvas, hint.action, theme.SMALL, theme.TEXT_SOFT, beside, row)
