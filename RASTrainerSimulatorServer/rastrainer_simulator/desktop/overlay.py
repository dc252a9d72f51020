"""Everything laid over the picture: painted when it changes, placed when the window does."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from itertools import zip_longest
from typing import Any

import numpy as np
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer_simulator.desktop.panels import strips, theme
from rastrainer_simulator.desktop.panels.brush import Brush
from rastrainer_simulator.desktop.panels.canvas import (
    Box,
    Side,
    Sprite,
    Thumbnail,
    frame_picture,
    fringe_picture,
    plain_picture,
)
from rastrainer_simulator.desktop.panels.controls_picture import (
    StickLook,
    knob_box,
    paint_knob,
    paint_stick,
    stick_boxes,
)
from rastrainer_simulator.desktop.panels.menu_panel import MenuPicture, menu_panel
from rastrainer_simulator.desktop.panels.tool_guidance import (
    REACH,
    STEP_DEG,
    BullsEye,
    DepthGauge,
    Direction,
    TouchRing,
    paint_bulls_eye,
    paint_gauge,
    paint_ring,
    target_arrow,
)
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.texts.texts import NO_NAMES

MAX_WARNINGS = 3
GLOW = 44
INSET_FRAME = 4
STICKS = ("left", "right")


@dataclass(frozen=True)
class Content:
    """What is laid over the picture.

    Attributes:
        screen: what the trainee reads.
        is_error: whether the touch goes wrong: the picture is framed in red.
        ring: about the tool's tip; None without one.
        inset: where the second view is; None without one.
        inset_title: what it shows.
        target: direction to a target out of sight, and its distance in mm.
        tool: direction to a tool out of sight.
        seen: what no panel may cover: pixels from the lower left corner.
        hovered: name of the item under the mouse.
        thumbnail: picture of the menu's item that has the focus; None without one.
        aim: how the planned line lies to the guide; None while none is aligned.
        gauge: how deep drill or instrument is; None while none is fed.
        sticks: the left and the right one that the mouse drags; none where they are not shown.
    """

    screen: Screen
    is_error: bool = False
    ring: TouchRing | None = None
    inset: Box | None = None
    inset_title: str = ""
    target: tuple[Direction, int] | None = None
    tool: Direction | None = None
    seen: tuple[tuple[int, int], ...] = ()
    hovered: str = ""
    thumbnail: Thumbnail | None = None
    aim: BullsEye | None = None
    gauge: DepthGauge | None = None
    sticks: tuple[StickLook, ...] = ()


class Overlay:
    """The panels of one window."""

    def __init__(self, renderer: vtkRenderer):
        self._slots = {name: _Slot(Sprite(renderer, order)) for order, name in enumerate(_SLOTS)}
        self._size = (0, 0)
        self._brush = Brush(1.0)
        self._menu: MenuPicture | None = None
        self._menu_box: Box | None = None
        self._shown: Content | None = None
        self._key_names: Mapping[str, str] = NO_NAMES

    def name_keys(self, key_names: Mapping[str, str]) -> None:
        """Draw keyboards from now on with what is written on the keys, by their W3C codes."""
        self._key_names, self._shown = key_names, None

    def item_at(self, x: float, y: float) -> str:
        """Return the name of the menu's item or of the hint at a pixel, from the upper left."""
        item = ""
        if self._menu is not None and self._menu_box is not None:
            item = self._menu.item_at(x - self._menu_box.left, y - self._menu_box.top)
        return item or self._hint_at(x, y)

    def _hint_at(self, x: float, y: float) -> str:
        shown = () if self._shown is None else self._shown.screen.hints
        if not any(hint.item for hint in shown):
            return ""
        room = self._size[0] - 2 * self._brush.px(theme.MARGIN)
        width, height = self._slots["hints"].sprite.size
        left = (self._size[0] - width) // 2
        top = self._size[1] - self._brush.px(theme.MARGIN) - height
        if not Box(left, top, width, height).contains(x, y):
            # Looked up repeatedly while the pointer rests.
            return ""
        boxes = strips.hint_boxes(shown, self._brush, room)
        hit = (hint.item for hint, box in boxes if box.contains(x - left, y - top))
        return next(hit, "")

    def show(self, content: Content, size: tuple[int, int]) -> bool:
        """Lay something over a window of so many pixels; return whether anything has changed."""
        if content == self._shown and size == self._size:
            return False
        self._shown, self._size = content, size
        self._brush = Brush(theme.scale_of(*size))
        self._show_error(content.is_error)
        self._show_ring(content.ring)
        self._show_inset(content.inset, content.inset_title)
        self._show_aside("aim", content.aim, paint_bulls_eye, content.inset)
        self._show_aside("gauge", content.gauge, paint_gauge, content.inset)
        self._show_sticks(content.sticks)
        top = self._show_top(content.screen)
        bottom = self._show_bottom(content)
        direction, distance_mm = content.target or (None, None)
        self._show_edge("target", direction, distance_mm, (top, bottom))
        self._show_edge("tool", content.tool, None, (top, bottom))
        self._show_menu(content, top, bottom)
        for name in _CLEARED:
            self._slots[name].sprite.show_through(content.seen)
        return True

    @property
    def _scale(self) -> float:
        return self._brush.scale

    def _place(self, name: str, left: int, top: int) -> None:
        sprite = self._slots[name].sprite
        sprite.show(left, self._size[1] - top - sprite.size[1])

    def _show_top(self, screen: Screen) -> int:
        """Show status, instruction and warnings; return how far down they reach."""
        brush, margin = self._brush, self._brush.px(theme.MARGIN)
        room = min(brush.px(theme.INSTRUCTION_WIDTH), self._size[0] - 2 * margin)
        aside = (self._size[0] - room) // 2 - 2 * margin
        if self._paint("status", screen.status, strips.status, brush, aside):
            # A menu is on the left, in place of the status, and there is no inset then.
            right = self._size[0] - margin - self._slots["status"].sprite.size[0]
            self._place("status", margin if screen.menu is None else right, margin)
        top = margin
        width, height = self._slots["status"].sprite.size
        if self._paint("legend", screen.coverage, strips.legend, brush, aside):
            self._place("legend", margin, margin + height + brush.px(theme.STEP))
            wide, high = self._slots["legend"].sprite.size
            if wide > aside + margin:
                width, height = wide, height + high + brush.px(theme.STEP)
        if screen.status and width > aside + margin:
            # Wider than the room beside the messages: they come below it.
            top += height + brush.px(1.5 * theme.STEP)
        message = screen.instruction if screen.instruction.text else None
        if self._paint("instruction", message, strips.instruction, brush, room):
            top = self._center("instruction", top)
        for index in range(MAX_WARNINGS):
            warning = screen.warnings[index] if index < len(screen.warnings) else None
            if self._paint(f"warning{index}", warning, strips.warning, brush, room):
                top = self._center(f"warning{index}", top)
        return top

    def _center(self, name: str, top: int) -> int:
        width, height = self._slots[name].sprite.size
        self._place(name, (self._size[0] - width) // 2, top)
        return top + height + self._brush.px(1.5 * theme.STEP)

    def _show_bottom(self, content: Content) -> int:
        """Show the hints; return how far up they reach."""
        screen = content.screen
        brush, margin = self._brush, self._brush.px(theme.MARGIN)
        room = self._size[0] - 2 * margin
        bottom = self._size[1] - margin
        shown = (screen.hints, content.hovered if self._is_hint(content.hovered) else "")
        if self._paint("hints", screen.hints and shown, strips.hints, brush, room):
            height = self._slots["hints"].sprite.size[1]
            self._center("hints", bottom - height)
            bottom -= height + self._brush.px(1.5 * theme.STEP)
        return bottom

    def _is_hint(self, item: str) -> bool:
        return self._shown is not None and any(h.item == item for h in self._shown.screen.hints)

    def _show_menu(self, content: Content, top: int, bottom: int) -> None:
        menu = content.screen.menu
        if self._paint("scrim", menu and theme.SCRIM, plain_picture):
            self._slots["scrim"].sprite.show(0, 0, *self._size)
        if menu is None:
            self._slots["menu"].hide()
            self._menu_box = None
            return
        room = (self._size[0] - 2 * self._brush.px(theme.MARGIN), bottom - top)
        slot = self._slots["menu"]
        shown = (content.hovered, content.thumbnail)
        names = tuple(self._key_names.items())
        if slot.needs_painting((menu, room, *shown, names, self._scale)):
            self._menu = menu_panel(menu, self._scale, room, *shown, self._key_names)
            slot.sprite.paint(self._menu.pixels)
        width, height = slot.sprite.size
        # To the left, so that the robot is seen beside it.
        left = min(self._brush.px(theme.MENU_LEFT), (self._size[0] - width) // 2)
        box = Box(left, top + (room[1] - height) // 2, width, height)
        self._menu_box = box
        self._place("menu", box.left, box.top)

    def _show_ring(self, ring: TouchRing | None) -> None:
        look = None if ring is None else (ring.radius, ring.stage)
        if self._paint("ring", look, paint_ring, self._brush) and ring is not None:
            half = self._slots["ring"].sprite.size[0] // 2
            self._place("ring", ring.x - half, ring.y - half)

    def _show_error(self, is_error: bool) -> None:
        """Frame the whole picture in red."""
        width, height = self._size
        thick = self._brush.px(GLOW)
        places = {
            Side.TOP: (0, height - thick, width, thick),
            Side.LEFT: (0, 0, thick, height),
            Side.BOTTOM: (0, 0, width, thick),
            Side.RIGHT: (width - thick, 0, thick, height),
        }
        for side, place in places.items():
            name = f"error {side.value}"
            if self._paint(name, is_error and thick, fringe_picture, theme.CONTACT, side):
                self._slots[name].sprite.show(*place)

    def _show_inset(self, box: Box | None, title: str) -> None:
        thick = self._brush.px(INSET_FRAME)
        outer = None if box is None else box.inset(-thick)
        is_shown = self._paint("inset", outer, frame_picture, thick, theme.INSET_EDGE)
        if is_shown and outer is not None:
            self._place("inset", outer.left, outer.top)
        if self._paint("title", box and (title,), strips.status, self._brush, 0) and box:
            step, height = self._brush.px(theme.STEP), self._slots["title"].sprite.size[1]
            self._place("title", box.left + step, box.top + box.height - step - height)

    def _show_aside(
        self, name: str, look: Any, paint: Callable[..., np.ndarray], inset: Box | None
    ) -> None:
        """Show a panel at the right edge, below the inset."""
        if not self._paint(name, look, paint, self._brush):
            return
        margin = self._brush.px(theme.MARGIN)
        top = margin if inset is None else inset.top + inset.height + margin
        self._place(name, self._size[0] - margin - self._slots[name].sprite.size[0], top)

    def _show_sticks(self, sticks: tuple[StickLook, ...]) -> None:
        boxes = stick_boxes(self._size)
        for name, box, look in zip_longest(STICKS, boxes, sticks):
            if self._paint(f"{name} stick", look and look.label, paint_stick, self._brush):
                self._place(f"{name} stick", box.left, box.top)
            is_pushed = look and (look.x, look.y) != (0.0, 0.0)
            shown = None if look is None else (is_pushed,)
            if self._paint(f"{name} knob", shown, paint_knob, self._brush):
                knob = knob_box(box, look, self._brush)
                self._place(f"{name} knob", knob.left, knob.top)

    def _show_edge(
        self,
        name: str,
        direction: Direction | None,
        distance_mm: int | None,
        room: tuple[int, int],
    ) -> None:
        """Show an arrow at the edge of the picture, between the panels above and below."""
        if direction is None:
            self._slots[name].hide()
            return
        angle = STEP_DEG * round(direction.angle_deg / STEP_DEG)
        self._paint(name, (angle, distance_mm), target_arrow, self._brush)
        half = self._brush.px(REACH) + 2
        reach = (self._size[0] / 2 - half - 4, self._size[1] / 2 - half - 4)
        x = self._size[0] / 2 + direction.across * reach[0]
        y = self._size[1] / 2 + direction.upward * reach[1]
        top, bottom = (self._size[1] - edge for edge in room)
        y = max(min(y, top - half), bottom + half)
        self._slots[name].sprite.show(round(x - half), round(y - half))

    def _paint(
        self, name: str, content: Any, paint: Callable[..., np.ndarray], *how: Hashable
    ) -> bool:
        """Paint a slot's content if it has changed, or hide it if there is none.

        Returns whether it is to be placed.
        """
        slot = self._slots[name]
        if not content:
            slot.hide()
            return False
        if slot.needs_painting((content, how)):
            slot.sprite.paint(paint(content, *how))
        return True


# From the farthest to the nearest.
_SLOTS = (
    "inset",
    "title",
    "ring",
    *(f"error {side.value}" for side in Side),
    "scrim",
    "target",
    "tool",
    "aim",
    "gauge",
    *(f"{name} {part}" for name in STICKS for part in ("stick", "knob")),
    "status",
    "legend",
    "hints",
    *(f"warning{index}" for index in range(MAX_WARNINGS)),
    "instruction",
    "menu",
)


_CLEARED = ("title", "aim", "gauge", "status", "legend", "hints", "instruction")
"""Panels that give way to tip and point; a warning does not."""


class _Slot:
    """A sprite and what it shows."""

    def __init__(self, sprite: Sprite):
        self.sprite = sprite
        self._key: Hashable = None

    def needs_painting(self, key: Hashable) -> bool:
        """Return whether the content to be painted has changed, and remember it."""
        needs_painting, self._key = key != self._key, key
        return needs_painting

    def hide(self) -> None:
        self.sprite.hide()
