"""Drawings of controls: the gamepad and the keyboard, and sticks to be dragged by the mouse."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import Color, rgba
from rastrainer_simulator.texts.texts import key_name

# In a frame that is 100 wide and 66 high, y down.
WIDTH, HEIGHT = 100.0, 66.0
BODY_COLOR = rgba(0x33415A)
PART = rgba(0x1A2436)
RIM = rgba(0x8DA0BD)
GRIPS = (((20, 30), (15, 52)), ((80, 30), (85, 52)))
STICKS = (((37, 43), "L"), ((63, 43), "R"))
FACES = (
    ((80, 36), "A", rgba(0x3CCB7F)),
    ((87, 28), "B", rgba(0xFF5252)),
    ((73, 28), "X", rgba(0x5AA2FF)),
    ((80, 20), "Y", rgba(0xFFB92E)),
)
LETTERS = ((0.0, "QWERTYUIOP"), (2.5, "ASDFGHJKL"), (7.0, "ZXCVBNM"))
"""For each row of keys, where it begins and what is on it."""
KEY_STEP = 9.0
SHOULDERS = (((12, 9), "LT"), ((74, 9), "RT"))


def draw_gamepad(canvas: Canvas, place: Box, brush: Brush) -> None:
    """Draw a gamepad as large as fits, at the top of `place`."""
    size = min(place.width / WIDTH, place.height / HEIGHT)
    left = place.left + (place.width - WIDTH * size) / 2
    pen = _Pen(canvas, brush, left, place.top, size)
    for (x, y), name in SHOULDERS:
        pen.slab(x, y - 6, 14, 10, 4, PART)
        pen.label(x + 7, y - 2, name, theme.TEXT_SOFT)
    for start, end in GRIPS:
        pen.line([start, end], 24, BODY_COLOR)
    pen.slab(8, 10, 84, 36, 16, BODY_COLOR)
    pen.cross(20, 28)
    for (x, y), name in STICKS:
        pen.disk(x, y, 9.5, PART, RIM)
        pen.disk(x, y, 6.5, BODY_COLOR, RIM)
        pen.label(x, y, name, theme.TEXT)
    for (x, y), name, color in FACES:
        pen.disk(x, y, 4.3, PART, color)
        pen.label(x, y, name, color)
    for x in (44, 56):
        pen.slab(x - 3, 22, 6, 3.4, 1.7, PART)


def draw_keyboard(
    canvas: Canvas, place: Box, inputs: Sequence[str], key_names: Mapping[str, str], brush: Brush
) -> None:
    """Draw the letters of a keyboard at the top of `place`, and below them other keys by name.

    `inputs` are the names of the keys that do something: these are colored. `key_names` says what
    is written on the keys, by their W3C codes.
    """
    pen = _Pen(canvas, brush, place.left, place.top, place.width / WIDTH)
    used = set(inputs)
    letters_shown = set()
    for row, (begin, places) in enumerate(LETTERS):
        for column, american in enumerate(places):
            letter = key_name(f"Key{american}", key_names)
            letters_shown.add(letter)
            pen.key(begin + column * KEY_STEP, row * KEY_STEP, KEY_STEP, letter, letter in used)
    x, y = 0.0, (len(LETTERS) + 0.3) * KEY_STEP
    for name in dict.fromkeys(inputs):
        if name in letters_shown:
            continue
        width = pen.width(name) + KEY_STEP
        if x and x + width > WIDTH:
            x, y = 0.0, y + KEY_STEP
        pen.key(x, y, width, name, True)
        x += width


class _Pen:
    """Draws in the drawing's own frame."""

    def __init__(self, canvas: Canvas, brush: Brush, left: float, top: float, size: float):
        self._canvas, self._brush = canvas, brush
        self._left, self._top, self._size = left, top, size

    def slab(
        self, x: float, y: float, width: float, height: float, radius: float, color: Color
    ) -> None:
        self._canvas.box(self._box(x, y, width, height), color, radius * self._size)

    def disk(self, x: float, y: float, radius: float, color: Color, rim: Color) -> None:
        box = self._box(x - radius, y - radius, 2 * radius, 2 * radius)
        self._canvas.box(box, color, radius * self._size)
        self._canvas.frame(box, rim, radius * self._size, max(1, round(0.7 * self._size)))

    def key(self, x: float, y: float, width: float, text: str, is_used: bool) -> None:
        box = self._box(x, y, width - 1.0, KEY_STEP - 1.0)
        self._canvas.box(box, theme.ACCENT if is_used else PART, 1.6 * self._size)
        self.label(x + (width - 1.0) / 2, y + (KEY_STEP - 1.0) / 2, text, theme.TEXT)

    def width(self, text: str) -> float:
        return self._brush.width(text, theme.SMALL_STRONG) / self._size

    def line(self, points: list[tuple[float, float]], thickness: float, color: Color) -> None:
        placed = [(self._left + x * self._size, self._top + y * self._size) for x, y in points]
        self._canvas.stroke(placed, thickness * self._size, color)

    def cross(self, x: float, y: float) -> None:
        for wide, high in ((16, 5.4), (5.4, 16)):
            self.slab(x - wide / 2, y - high / 2, wide, high, 1.5, PART)
        for quarter in range(4):
            angle = quarter * math.pi / 2
            ahead, aside = (math.cos(angle), math.sin(angle)), (-math.sin(angle), math.cos(angle))
            corners = [(6.6, 0.0), (4.6, 1.5), (4.6, -1.5)]
            placed = [
                (
                    self._left + (x + far * ahead[0] + off * aside[0]) * self._size,
                    self._top + (y + far * ahead[1] + off * aside[1]) * self._size,
                )
                for far, off in corners
            ]
            self._canvas.polygon(placed, RIM)

    def label(self, x: float, y: float, text: str, color: Color) -> None:
        style = theme.SMALL_STRONG
        left = round(self._left + x * self._size - self._brush.width(text, style) / 2)
        top = round(self._top + y * self._size - self._brush.line_height(style) / 2)
        self._brush.write(self._canvas, text, style, color, left, top)

    def _box(self, x: float, y: float, width: float, height: float) -> Box:
        return Box(
            round(self._left + x * self._size),
            round(self._top + y * self._size),
            round(width * self._size),
            round(height * self._size),
        )


DIAMETER, KNOB = 264, 88
ABOVE_HINTS = 172
"""How far a stick's lower end is above the window's."""
_TEXT_SHARE, _TEXT_TOP = 0.6, 0.66


@dataclass(frozen=True)
class StickLook:
    """One stick.

    Attributes:
        label: what it does.
        x, y: how far it is pushed right and up, −1 to 1 each.
    """

    label: str
    x: float = 0.0
    y: float = 0.0


def stick_boxes(size: tuple[int, int]) -> tuple[Box, Box]:
    """Return where the left and the right stick are in a window of so many pixels."""
    brush = Brush(theme.scale_of(*size))
    wide, margin = brush.px(DIAMETER), brush.px(theme.MARGIN)
    top = size[1] - brush.px(ABOVE_HINTS) - wide
    return Box(margin, top, wide, wide), Box(size[0] - margin - wide, top, wide, wide)


def knob_box(stick: Box, look: StickLook, brush: Brush) -> Box:
    """Return where the knob of a stick is."""
    wide = brush.px(KNOB)
    reach = (stick.width - wide) / 2.0
    left = stick.left + reach + reach * look.x
    top = stick.top + reach - reach * look.y
    return Box(round(left), round(top), wide, wide)


def paint_stick(label: str, brush: Brush) -> np.ndarray:
    """Return the ground of a stick with what it does."""
    wide = brush.px(DIAMETER)
    canvas, whole = Canvas(wide, wide), Box(0, 0, wide, wide)
    canvas.box(whole, theme.GLASS, wide / 2)
    canvas.frame(whole, theme.TEXT, wide / 2, brush.px(3))
    top = round(_TEXT_TOP * wide)
    for line in brush.wrap(label, theme.SMALL, _TEXT_SHARE * wide):
        left = (wide - brush.width(line, theme.SMALL)) // 2
        brush.write(canvas, line, theme.SMALL, theme.TEXT, left, top)
        top += brush.line_height(theme.SMALL)
    return canvas.pixels()


def paint_knob(is_pushed: bool, brush: Brush) -> np.ndarray:
    """Return the knob of a stick."""
    wide = brush.px(KNOB)
    canvas, whole = Canvas(wide, wide), Box(0, 0, wide, wide)
    canvas.box(whole, theme.ACCENT, wide / 2)
    canvas.frame(whole, theme.TEXT if is_pushed else theme.ACCENT_EDGE, wide / 2, brush.px(4))
    return canvas.pixels()
