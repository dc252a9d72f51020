"""The current picture: the simulator's latest messages, drawn."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import lru_cache

import numpy as np
import pygame

from rastrainer.protocol import OPEN_PHASES, Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.desktop.gl_window import GlWindow
from rastrainer_simulator.desktop.head_marks import ErrorArrows, TraceMarks
from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene, Viewpoint
from rastrainer_simulator.desktop.keyboard_and_mouse import Push
from rastrainer_simulator.desktop.overlay import Content, Overlay
from rastrainer_simulator.desktop.panels.canvas import COVERS_PX
from rastrainer_simulator.desktop.panels.controls_picture import StickLook
from rastrainer_simulator.desktop.panels.tool_guidance import (
    Direction,
    TouchRing,
    bulls_eye,
    depth_gauge,
    direction_out_of_sight,
    pixel_of,
    touch_ring,
)
from rastrainer_simulator.desktop.shown_scene import ShownScene
from rastrainer_simulator.desktop.viewports import Quality, Viewports
from rastrainer_simulator.ops.system_paths import has_letters
from rastrainer_simulator.presentation.look import PULSE_S
from rastrainer_simulator.presentation.messages import ProcedureNews, StateNews
from rastrainer_simulator.presentation.screen import Menu, Screen, focused_picture
from rastrainer_simulator.state import TOUCH_ERRORS
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from rastrainer_simulator.trial_state import Tool

REST_S = 3.0
NOWHERE = (-1, -1)


class Pointer:
    """Hides the pointer when it rests, so that it marks nothing for those who use a gamepad."""

    def __init__(self) -> None:
        self._place = NOWHERE
        self._moved = -REST_S
        self._is_visible = True
        self._is_hand = False

    def move(self, place: tuple[int, int], now: float) -> None:
        """Note that the mouse was moved or clicked at `now` (s)."""
        self._place, self._moved = place, now

    def place(self, now: float) -> tuple[int, int]:
        """Return where it points, in pixels from the upper left; NOWHERE while it rests."""
        is_visible = now - self._moved < REST_S
        if is_visible != self._is_visible:
            self._is_visible = is_visible
            pygame.mouse.set_visible(is_visible)
        return self._place if is_visible else NOWHERE

    def point(self, can_click: bool) -> None:
        """Become a hand over what can be clicked."""
        if can_click != self._is_hand:
            self._is_hand = can_click
            shape = pygame.SYSTEM_CURSOR_HAND if can_click else pygame.SYSTEM_CURSOR_ARROW
            pygame.mouse.set_cursor(shape)


def notice(key: str, language: str) -> Screen:
    """Return what the trainee reads while there is no connection."""
    texts = Texts(LANGUAGES.get(language, {}))
    return Screen(menu=Menu("notice", texts.say("window.title"), (texts.say(key),)))


@lru_cache(maxsize=8)
def own_facts(language: str, holder: str, pairing: tuple[str, str] | None) -> tuple[str, ...]:
    """Return who has control, and how to pair another view if that should be shown."""
    texts = Texts(LANGUAGES.get(language, {}))
    key = f"source.{holder}"
    source = texts.say(key) if key in texts else holder
    fact = texts.say("control.holder", source=source) if holder else texts.say("control.nobody")
    if pairing is None:
        return (fact,)
    code, addresses = pairing
    return fact, texts.say("window.pairing", code=code, addresses=addresses)


FAR = "far"
BESIDE_MENU = 0.44
PULSE_HZ: Mapping[Quality, float] = {Quality.HIGH: 30.0, Quality.MEDIUM: 30.0, Quality.LOW: 4.0}


class Picture:
    """Draws the inbox into the window, and only when something in it has changed.

    Attributes:
        pointer: the mouse's.
        pushes: deflection of the sticks that the mouse drags.
    """

    def __init__(self, window: GlWindow, inbox: Inbox, quality: Quality):
        self._window = window
        self._inbox = inbox
        self.viewports = Viewports(window, quality)
        self._overlay = Overlay(self.viewports.overlay)
        self._scene: ShownScene | None = None
        self._errors = ErrorArrows()
        self._trace = TraceMarks()
        self._loaded: LoadedScene | None = None
        self._drawn_state: StateNews | None = None
        self._cleared: tuple[ShownScene | None, bool] = (None, False)
        self._pulse_step = 0
        self._must_draw = True
        self._drawn_menu = ""
        self.pointer = Pointer()
        self.pushes: tuple[Push, Push] = ((0.0, 0.0), (0.0, 0.0))

    @property
    def has_sticks(self) -> bool:
        screen = self._inbox.screen
        is_free = screen is not None and screen.menu is None and screen.has_sticks
        return is_free and self._inbox.has_control and not self._inbox.problem

    def name_keys(self, key_names: Mapping[str, str]) -> None:
        """Draw keyboards with what is written on the keys, by their W3C codes."""
        self._overlay.name_keys(key_names)

    def item_at_pointer(self, now: float) -> str:
        """Return the name of the menu's item under the mouse."""
        return self._overlay.item_at(*self.pointer.place(now))

    def item_to_choose(self, now: float) -> str:
        """Return the item that a click at the mouse chooses.

        That is none while the menu that is drawn has been left, or another one has opened since:
        the click was meant for what was seen.
        """
        return "" if self._drawn_menu != self._menu else self.item_at_pointer(now)

    @property
    def _menu(self) -> str:
        screen = self._inbox.screen
        return "" if screen is None or screen.menu is None else screen.menu.name

    def redraw(self) -> None:
        """Draw at the next opportunity, whatever has changed."""
        self._must_draw = True

    def is_due(self, now: float) -> bool:
        """Process what has arrived, and return whether the picture must be drawn."""
        self._window.fit()
        self._inbox.read_state()
        self._take_scene()
        self._take_state(now)
        screen = self._inbox.screen
        is_free = screen is None or screen.menu is None
        self.viewports.wants_inset = is_free and not self._is_under_inset()
        if self._errors.show(() if screen is None else screen.errors):
            self._must_draw = True
        self._show_trace()
        self._clear_head(screen is not None and screen.is_head_clear)
        self.viewports.prepare(now)
        if self._overlay.show(self._content(now), self._window.size):
            self._must_draw = True
        return self._must_draw or self.viewports.is_moving(now)

    def draw(self) -> bool:
        """Draw it; return whether it shows another menu than before, or none any more."""
        self._must_draw = False
        self._window.render_window.Render()
        before, self._drawn_menu = self._drawn_menu, self._menu
        return self._drawn_menu != before

    def set_quality(self, quality: Quality) -> None:
        """Draw better, or faster."""
        self.viewports.set_quality(quality)
        self._drawn_state = None

    def _show_trace(self) -> None:
        head = None if self._scene is None else self._scene.poses.get("head")
        if self._scene is None or head is None or not self._trace.show(self._inbox.trace, head):
            return
        self._scene.paint_skin(self._inbox.trace)
        self._must_draw = True

    def _clear_head(self, is_clear: bool) -> None:
        wanted = (self._scene, is_clear)
        if self._scene is not None and wanted != self._cleared:
            self._cleared = wanted
            self._scene.clear_head(is_clear)
            self.viewports.arrange()
            self._must_draw = True

    def _show_instrument(self, procedure: ProcedureNews | None) -> None:
        assert self._scene is not None
        assert self._loaded is not None
        if procedure is None:
            self._scene.show_instrument(Tool.POINTER, 0.0, ())
            return
        no_go = self._loaded.no_go.get(procedure.name, ())
        self._scene.show_instrument(procedure.tool, procedure.feed_mm / MM_PER_M, no_go)

    def _take_scene(self) -> None:
        loaded = self._inbox.scene
        if loaded is None or loaded is self._loaded:
            return
        self._loaded, self._drawn_state = loaded, None
        self._scene = ShownScene(loaded.parts, self.viewports.quality.is_physical)
        self._scene.moving += [*self._errors.actors, *self._trace.actors]
        self._scene.paint_skin(self._inbox.trace)
        self.viewports.show(self._scene, loaded.cameras)

    def _take_state(self, now: float) -> None:
        state = self._inbox.state
        if self._scene is None or state is None:
            return
        if _differs(state, self._drawn_state):
            self._scene.place(dict(zip(self._inbox.bodies, state.poses, strict=True)))
            self._scene.place_ghost(state.ghost)
            self.viewports.see_through(state.translucent)
            self._show_instrument(state.procedure)
            self._must_draw = True
        self._drawn_state = state
        self._choose_camera(state, now)
        self._mark(now)

    def _choose_camera(self, state: StateNews, now: float) -> None:
        """Set the view that the simulator chose: aside for a menu, from afar without a trial."""
        screen = self._inbox.screen
        view = Viewpoint.of(state.view)
        beside = None if state.inset is None else Viewpoint.of(state.inset)
        if screen is None or screen.menu is None:
            self.viewports.choose(state.camera, now, view=view, beside=beside)
        elif state.phase == Phase.IDLE and FAR in self.viewports.cameras:
            self.viewports.choose(FAR, now, BESIDE_MENU)
        else:
            self.viewports.choose(state.camera, now, BESIDE_MENU, view, beside)

    def _mark(self, now: float) -> None:
        """Color what the state says; the next fiducial grows brighter and darker again."""
        state = self._inbox.state
        if self._scene is None or state is None:
            return
        self._scene.mark(state.next, state.touched, state.touch)
        if state.next is None or self._inbox.problem:
            return
        step = math.floor(now * PULSE_HZ[self.viewports.quality])
        if step != self._pulse_step:
            self._pulse_step = step
            self._scene.pulse(0.5 - 0.5 * math.cos(2.0 * math.pi * now / PULSE_S))
            self._must_draw = True

    def _content(self, now: float) -> Content:
        screen = self._inbox.screen or Screen()
        if self._inbox.problem:
            return Content(notice(self._inbox.problem, screen.language))
        if not has_letters(screen.language):
            return Content(notice("window.no font", "en"))
        state = self._inbox.state
        is_free = screen.menu is None
        pairing = None if is_free else self._inbox.pairing
        procedure = state.procedure if state is not None and is_free else None
        texts = Texts(LANGUAGES.get(screen.language, {}))
        facts = own_facts(screen.language, self._inbox.holder, pairing)
        hovered = self.item_at_pointer(now)
        self.pointer.point(bool(hovered))
        return Content(
            screen=replace(screen, status=(*screen.status, *facts)),
            is_error=is_free and state is not None and state.touch in TOUCH_ERRORS,
            ring=self._ring() if is_free else None,
            inset=self.viewports.inset_box if self.viewports.has_inset else None,
            inset_title=texts.say(f"window.{self._inset_name()}"),
            target=self._target() if is_free and screen.has_arrow else None,
            tool=self._out_of_sight(self._tip) if is_free else None,
            seen=self._seen() if is_free else (),
            hovered=hovered,
            thumbnail=self._inbox.thumbnails.get(focused_picture(screen.menu)),
            aim=bulls_eye(procedure, texts),
            gauge=depth_gauge(screen.ruler, procedure, texts),
            sticks=self._sticks(texts),
        )

    def _sticks(self, texts: Texts) -> tuple[StickLook, ...]:
        """Return the sticks that the mouse drags; none where they are not shown."""
        if not self.has_sticks:
            return ()
        labels = texts.say("window.left stick"), texts.say("window.right stick")
        return tuple(
            StickLook(label, *push) for label, push in zip(labels, self.pushes, strict=True)
        )

    def _ring(self) -> TouchRing | None:
        """Return the ring about the tip, where it is near the head."""
        state, tip = self._inbox.state, self._tip
        if state is None or tip is None:
            return None
        return touch_ring(state, tip, self.viewports.main, self._window.size)

    def _target(self) -> tuple[Direction, int] | None:
        """Return the direction to the next point and its distance in mm, if out of sight."""
        place, tip = self._next_place, self._tip
        direction = self._out_of_sight(place)
        if direction is None or place is None or tip is None:
            return None
        return direction, round(MM_PER_M * float(np.linalg.norm(place - tip)))

    @property
    def _next_place(self) -> np.ndarray | None:
        """(3,) float, World, m: the next point, or the place to draw next."""
        state, scene = self._inbox.state, self._scene
        head = None if scene is None else scene.poses.get("head")
        if head is None or self._loaded is None or state is None:
            return None
        traced = self._inbox.trace.place
        place = self._loaded.fiducials.get(state.next or "", traced and traced[0])
        return None if place is None else head[:3, :3] @ place + head[:3, 3]

    @property
    def _tip(self) -> np.ndarray | None:
        """(3,) float, World, m: the tip of the tool in an open trial."""
        state, scene = self._inbox.state, self._scene
        tool = None if scene is None else scene.poses.get("tool")
        is_open = state is not None and state.phase in OPEN_PHASES
        return tool[:3, 3] if tool is not None and is_open else None

    def _out_of_sight(self, place: np.ndarray | None) -> Direction | None:
        if place is None:
            return None
        return direction_out_of_sight(self.viewports.main, place, self._window.size)

    def _seen(self) -> tuple[tuple[int, int], ...]:
        """Return where tip and next point are, in pixels from the lower left corner."""
        tip = self._tip
        places = () if tip is None else (tip, self._next_place)
        found = (
            pixel_of(self.viewports.main, place, self._window.size)
            for place in places
            if place is not None
        )
        return tuple(pixel for pixel in found if pixel is not None)

    def _is_under_inset(self) -> bool:
        """Return whether the inset would cover tip or next point."""
        box, height = self.viewports.inset_box, self._window.size[1]
        around = box.inset(-COVERS_PX * (1 if self.viewports.wants_inset else 2))
        return any(around.contains(x, height - y) for x, y in self._seen())

    def _inset_name(self) -> str:
        """Return the name of what the inset shows."""
        state = self._inbox.state
        if state is None or state.inset is None:
            shown = "" if state is None else state.camera
            return next((name for name in self.viewports.cameras if name != shown), FAR)
        procedure = state.procedure
        has_line = procedure is not None and procedure.tool is not Tool.POINTER
        return "across" if has_line else "beside"


_UNSEEN = (
    "tick",
    "planned_target",
    "time_s",
    "elapsed_s",
    "delayed",
    "clearance_mm",
    "proximity",
    "phase",
)


def _differs(state: StateNews, other: StateNews | None) -> bool:
    """Return whether two states look different."""
    if other is None:
        return True
    unseen = {name: getattr(state, name) for name in _UNSEEN}
    return replace(other, **unseen) != state
