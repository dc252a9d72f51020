"""A menu as a panel: headline, text, table and rows, as large as its content and the window."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas, Thumbnail
from rastrainer_simulator.desktop.panels.controls_picture import draw_gamepad, draw_keyboard
from rastrainer_simulator.desktop.panels.item_row import (
    Look,
    draw_item,
    draw_trend,
    fits,
    trend_height,
)
from rastrainer_simulator.presentation.screen import Menu
from rastrainer_simulator.texts.texts import NO_NAMES

SHRINK = 0.94
SMALLEST = 0.84
_ROWS: tuple[float, float] = (theme.ROW_HEIGHT, 1.25 * theme.STEP)
_CLOSE_ROWS: tuple[float, float] = (5.75 * theme.STEP, 0.5 * theme.STEP)
"""How high a row is, and how far from the next."""
_FACT_HEIGHT = 5.5 * theme.STEP
_PICTURE_HEIGHT = 0.75
"""Of a thumbnail as large as its column is wide."""


@dataclass(frozen=True)
class MenuPicture:
    """A painted menu.

    Attributes:
        pixels: (height, width, 4) uint8.
        rows: where each item that can be seen is, in the picture.
    """

    pixels: np.ndarray
    rows: dict[str, Box]

    def item_at(self, x: float, y: float) -> str:
        """Return the name of the item at a pixel, "" where there is none."""
        return next((name for name, box in self.rows.items() if box.contains(x, y)), "")


def menu_panel(
    menu: Menu,
    scale: float,
    room: tuple[int, int],
    hovered: str = "",
    thumbnail: Thumbnail | None = None,
    key_names: Mapping[str, str] = NO_NAMES,
) -> MenuPicture:
    """Paint a menu into at most `room` (width, height) pixels.

    The item `hovered` is under the mouse; `thumbnail` belongs to the one that has the focus.
    `key_names` says what is written on the keys.

    What is too high is set smaller, down to what is still readable, then with closer rows, then,
    as where these are clipped, wider, and with its text beside its rows; beyond that the rows
    scroll with the focus.
    """
    factor, width, widths, rows = 1.0, theme.PANEL_WIDTH, [theme.BROAD_PANEL_WIDTH], _ROWS
    if menu.paragraphs:
        widths.insert(0, theme.WIDE_PANEL_WIDTH)
    layout = _Layout(menu, Brush(scale), room, width, rows)
    while layout.height > room[1] or (rows is _CLOSE_ROWS and layout.is_clipped):
        if factor > SMALLEST:
            factor *= SHRINK
        elif rows is _ROWS:
            rows = _CLOSE_ROWS
        elif widths:
            width = widths.pop()
        else:
            break
        layout = _Layout(menu, Brush(scale * factor), room, width, rows)
    return layout.paint(hovered, thumbnail, key_names)


class _Layout:
    """The layout of a menu, at one scale.

    A picture needs its own width; without one, the widest panel has its text in two columns, of
    which the second is wider where a label with its value needs it.
    A trend has the text under it.
    """

    def __init__(
        self,
        menu: Menu,
        brush: Brush,
        room: tuple[int, int],
        width: int,
        rows: tuple[float, float],
    ):
        self._menu = menu
        self._brush = brush
        self._row, self._gap = (brush.px(units) for units in rows)
        self._pad = brush.px(theme.PANEL_PAD)
        has_picture = (
            bool(menu.picture) or menu.trend is not None or any(item.picture for item in menu.items)
        )
        self._width = min(brush.px(theme.WIDE_PANEL_WIDTH if has_picture else width), room[0])
        inside = self._width - 2 * self._pad
        self._picture_width = round(0.42 * inside) if has_picture else 0
        is_in_columns = not has_picture and width >= theme.WIDE_PANEL_WIDTH
        self._is_split = is_in_columns or menu.trend is not None
        aside = self._picture_width
        if is_in_columns:
            half = (inside - self._pad) // 2
            aside = min(half, max(inside - self._pad - self._facts_width(), round(0.8 * half)))
        self._left = self._pad + aside + (self._pad if aside else 0)
        self._text_width = self._width - self._pad - self._left
        self._title = brush.wrap(menu.title, theme.TITLE, inside)
        room_of_text = aside if self._is_split else self._text_width
        self._lines = [brush.wrap(text, theme.BODY, room_of_text) for text in menu.paragraphs]
        self._plot = 0
        if menu.trend is not None:
            self._plot = trend_height(brush, self._picture_width) + brush.px(theme.GAP)
        self._help = max(
            (
                len(brush.wrap(item.help, theme.SMALL, self._text_width))
                for item in menu.items
                if item.help
            ),
            default=0,
        )
        above, below = self._heights()
        least = 0
        if any(item.picture for item in menu.items):
            least = self._height_beside(round(_PICTURE_HEIGHT * self._picture_width))
        elif self._is_split:
            least = self._height_beside(self._plot + self._lines_height())
        self.height = max(above + self._rows_height(len(menu.items)) + below, least)
        fitting = max(1, (room[1] - above - below) // (self._row + self._gap))
        self._shown = self._rows_in_sight(min(len(menu.items), fitting))
        shown = above + self._rows_height(len(self._shown)) + below
        self._height = min(self.height, max(shown, least))

    @property
    def is_clipped(self) -> bool:
        """Whether an item is too wide for its row."""
        return not all(fits(item, self._brush, self._text_width) for item in self._menu.items)

    def _facts_width(self) -> int:
        """Return the width in which every label has its value beside it."""
        brush, gap = self._brush, self._brush.px(theme.PAD)
        widths = (
            brush.width(fact.label, theme.BODY) + gap + brush.width(fact.value, theme.STRONG)
            for fact in self._menu.facts
        )
        return math.ceil(max(widths, default=0))

    def _rows_height(self, count: int) -> int:
        return count * (self._row + self._gap) - self._gap if count else 0

    def _heights(self) -> tuple[int, int]:
        """Return how much is above the rows, and how much is below them."""
        brush = self._brush
        above = self._pad + len(self._title) * brush.line_height(theme.TITLE) + brush.px(theme.PAD)
        if not self._is_split:
            above += self._lines_height()
        facts = len(self._menu.facts)
        above += facts * brush.px(_FACT_HEIGHT) + (brush.px(theme.PAD) if facts else 0)
        below = self._pad
        if self._help:
            below += self._help * brush.line_height(theme.SMALL) + brush.px(theme.GAP)
        return above, below

    def _lines_height(self) -> int:
        gap, height = self._brush.px(theme.GAP), self._brush.line_height(theme.BODY)
        return sum(len(lines) * height + gap for lines in self._lines)

    def _height_beside(self, content: int) -> int:
        """Return the height needed by what stands beside the rows alone."""
        title = len(self._title) * self._brush.line_height(theme.TITLE)
        return 2 * self._pad + title + self._brush.px(theme.PAD) + content

    def _rows_in_sight(self, count: int) -> range:
        names = [item.name for item in self._menu.items]
        focus = names.index(self._menu.focus) if self._menu.focus in names else 0
        first = min(max(0, focus - count // 2), len(names) - count)
        return range(first, first + count)

    def paint(
        self, hovered: str, thumbnail: Thumbnail | None, key_names: Mapping[str, str]
    ) -> MenuPicture:
        """Paint it."""
        brush = self._brush
        canvas = Canvas(self._width, self._height)
        whole = Box(0, 0, self._width, self._height)
        radius = brush.px(theme.PANEL_RADIUS)
        canvas.box(whole, theme.NIGHT, radius)
        canvas.frame(whole, theme.EDGE, radius, brush.px(1.5))
        top = self._pad
        for line in self._title:
            brush.write(canvas, line, theme.TITLE, theme.TEXT, self._pad, top)
            top += brush.line_height(theme.TITLE)
        top += brush.px(theme.PAD)
        if self._picture_width:
            place = Box(self._pad, top, self._picture_width, self._height - top - self._pad)
            if self._menu.picture == "keyboard":
                inputs = [key for fact in self._menu.facts for key in fact.value.split(" / ")]
                draw_keyboard(canvas, place, inputs, key_names, brush)
            elif self._menu.picture:
                draw_gamepad(canvas, place, brush)
            elif self._menu.trend is not None:
                draw_trend(canvas, place, self._menu.trend, brush)
            elif thumbnail is not None:
                pixels = thumbnail.fitted(place.width, place.height)
                canvas.picture(place.left, place.top, pixels)
        top = self._paint_text(canvas, top)
        rows = self._paint_rows(canvas, top, hovered)
        self._paint_help(canvas)
        return MenuPicture(canvas.pixels(), rows)

    def _paint_text(self, canvas: Canvas, top: int) -> int:
        brush, begin = self._brush, top
        left = self._pad if self._is_split else self._left
        top += self._plot
        for lines in self._lines:
            for line in lines:
                brush.write(canvas, line, theme.BODY, theme.TEXT_SOFT, left, top)
                top += brush.line_height(theme.BODY)
            top += brush.px(theme.GAP)
        if self._is_split:
            top = begin
        height = brush.px(_FACT_HEIGHT)
        for fact in self._menu.facts:
            row = top + (height - brush.line_height(theme.BODY)) // 2
            value = brush.fit(fact.value, theme.STRONG, 0.7 * self._text_width)
            width = brush.width(value, theme.STRONG)
            room = self._text_width - width - brush.px(theme.PAD)
            label = brush.fit(fact.label, theme.BODY, room)
            brush.write(canvas, label, theme.BODY, theme.TEXT_SOFT, self._left, row)
            tone = theme.TEXT if fact.tone == "plain" else theme.TONES[fact.tone]
            right = self._left + self._text_width - width
            brush.write(canvas, value, theme.STRONG, tone, right, row)
            top += height
            rule = Box(self._left, top - brush.px(1), self._text_width, brush.px(1))
            canvas.box(rule, theme.EDGE)
        return top + (brush.px(theme.PAD) if self._menu.facts else 0)

    def _paint_rows(self, canvas: Canvas, top: int, hovered: str) -> dict[str, Box]:
        rows: dict[str, Box] = {}
        for index in self._shown:
            item = self._menu.items[index]
            row = Box(self._left, top, self._text_width, self._row)
            look = Look(item.name == self._menu.focus, item.name == hovered)
            draw_item(canvas, item, look, self._brush, row)
            rows[item.name] = row
            top += self._row + self._gap
        self._paint_more(canvas, rows)
        return rows

    def _paint_more(self, canvas: Canvas, rows: dict[str, Box]) -> None:
        """Mark that there are rows out of sight by a bar beside those in sight."""
        count = len(self._menu.items)
        if not rows or len(rows) == count:
            return
        boxes = list(rows.values())
        high = boxes[-1].top + boxes[-1].height - boxes[0].top
        x = self._left + self._text_width + self._pad // 2
        track = Box(x, boxes[0].top, self._brush.px(theme.STEP), high)
        canvas.box(track, theme.FIELD, track.width / 2)
        start = boxes[0].top + round(high * self._shown.start / count)
        thumb = Box(x, start, track.width, round(high * len(rows) / count))
        canvas.box(thumb, theme.TEXT_PALE, track.width / 2)

    def _paint_help(self, canvas: Canvas) -> None:
        brush = self._brush
        focused = [item for item in self._menu.items if item.name == self._menu.focus]
        if not focused or not focused[0].help:
            return
        line_height = brush.line_height(theme.SMALL)
        top = self._height - self._pad - self._help * line_height
        for line in brush.wrap(focused[0].help, theme.SMALL, self._text_width):
            brush.write(canvas, line, theme.SMALL, theme.TEXT_SOFT, self._left, top)
            top += line_height
