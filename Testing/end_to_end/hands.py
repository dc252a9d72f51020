"""A trainee's input devices: at the simulator, in its window, on the page, and in the headset."""

from __future__ import annotations

import math
from collections.abc import Sequence
from contextlib import suppress
from types import SimpleNamespace

from playwright.sync_api import Error, Page

from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.inputs import ControlName
from Testing.end_to_end.virtual_display import VirtualKeyboard
from Testing.end_to_end.virtual_gamepad import SimulatorWithGamepad

HELD_S = 0.02
STICKS = (("KeyA", "KeyD"), ("KeyS", "KeyW"), ("KeyF", "KeyR"))


class GamepadHands:
    """A gamepad, held as a Logitech F310 is."""

    def __init__(self, simulator: SimulatorWithGamepad):
        self._simulator = simulator

    def tap(self, control: str) -> None:
        self._simulator.tap(DEFAULT_BINDINGS.gamepad[ControlName(control)][0], HELD_S)

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        self._simulator.move(
            leftx=right, lefty=-forward, righty=-up, righttrigger=1.0 if fine else 0.0
        )


class KeyHands:
    """The keys of the window, which are pressed or not: the largest deflections are held."""

    def __init__(self, keyboard: VirtualKeyboard):
        self.keyboard = keyboard
        self._held: set[str] = set()

    def tap(self, control: str) -> None:
        self.keyboard.tap(DEFAULT_BINDINGS.keyboard[ControlName(control)][0])

    def type(self, text: str) -> None:
        for letter in text:
            self.keyboard.tap(f"Key{letter}" if letter.isalpha() else f"Digit{letter}")

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        self._hold((right, forward, up), STICKS, fine)

    def _hold(self, values: tuple, keys: tuple, fine: bool) -> None:
        """Hold the keys of the larger values, each of which has two: below and above 0."""
        wanted = {"ShiftLeft"} if fine else set()
        longest = max(map(abs, values))
        for value, (below, above) in zip(values, keys, strict=True):
            if abs(value) > 0.5 * longest > 0.0:
                wanted.add(above if value > 0.0 else below)
        for code in sorted(self._held - wanted):
            self.keyboard.hold(code, False)
        for code in sorted(wanted - self._held):
            self.keyboard.hold(code, True)
        self._held = wanted


BUTTONS = {"accept": 0, "touch": 0, "back": 1, "undo": 1, "camera": 3, "menu": 9}
BUTTONS |= {"up": 12, "down": 13, "left": 14, "right": 15}
FINE_BUTTON = 7
CONTROLLER_BUTTONS = {
    "accept": ("right", "a-button"),
    "touch": ("right", "a-button"),
    "back": ("right", "b-button"),
    "undo": ("right", "b-button"),
    "camera": ("left", "y-button"),
    "menu": ("left", "x-button"),
}
STEPS = {"up": (0, -1), "down": (0, 1), "left": (-1, 0), "right": (1, 0)}

_POINT = """async (name) => {
  const { panels, placement } = page.headset;
  const has = (panel) => panel.regions.some((region) => region.name === name);
  const find = () => [panels.menu, panels.actions, panels.work].find(has);
  // The simulator's menu may not have been drawn yet.
  const giveUp = performance.now() + 120_000;
  while (!find() && performance.now() < giveUp) await frames_(1);
  const panel = find();
  if (!panel) throw new Error(`No panel has ${name}.`);
  const { x, y, width, height } = panel.regions.find((region) => region.name === name);
  const size = panel.mesh.geometry.parameters;
  const target = panel.mesh.position.clone().set(
    ((x + width / 2) / panel.canvas.width - 0.5) * size.width,
    (0.5 - (y + height / 2) / panel.canvas.height) * size.height, 0);
  placement.rig.worldToLocal(panel.mesh.localToWorld(target));
  const hand = panel.mesh.position.clone().copy(device.position);
  hand.x += 0.2;
  hand.y -= 0.4;
  const aim = new placement.rig.constructor();
  aim.position.copy(target);
  aim.lookAt(hand);
  const isHand = device.primaryInputMode === "hand";
  const right = (isHand ? device.hands : device.controllers).right;
  const pull = (value) =>
    isHand ? right.updatePinchValue(value) : right.updateButtonValue("trigger", value);
  right.position.set(hand.x, hand.y, hand.z);
  right.quaternion.set(...aim.quaternion.toArray());
  await frames_(3);
  pull(1);
  await frames_(3);
  pull(0);
  await frames_(3);
}"""
_MOVE = """async (by) => {
  const right = device.controllers.right;
  const { x, y, z } = right.position;
  const ray = page.headset.hands.hands.find((hand) => hand.source?.handedness === "right").ray;
  const before = ray.getWorldPosition(ray.position.clone());
  right.position.set(x + by[0], y + by[1], z + by[2]);
  await frames_(2);
  const moved = ray.getWorldPosition(ray.position.clone()).sub(before);
  return [moved.x, -moved.z, moved.y];
}"""


_IS_TARGET = """(target) => {
  const place = document.querySelector(target);
  if (place === null || getComputedStyle(place).cursor !== "pointer") return false;
  const { width, height } = place.getBoundingClientRect();
  return Math.min(width, height) >= 24;
}"""
"""Whether a target looks clickable, and is as large as WCAG 2.2 requires (2.5.8).

One look answers both: between two, the page may put another element in its place.
"""
_FINE_HINT = "#hints [data-item='press fine']"
_SLOW_IS = """(word) =>
  document.querySelector("#hints [data-item='press fine']")?.textContent.endsWith(word)"""


class PageKeys(KeyHands):
    """The keyboard, on the page."""

    def __init__(self, page: Page):
        keys = page.keyboard

        def hold(code: str, is_down: bool) -> None:
            (keys.down if is_down else keys.up)(code)

        super().__init__(SimpleNamespace(tap=keys.press, hold=hold))


class BrowserPad:
    """A gamepad in the W3C's standard layout."""

    def __init__(self, page: Page):
        self._page = page

    def tap(self, control: str) -> None:
        index = BUTTONS[control]
        self._page.evaluate(
            "async (i) => { press(i, 1); await frames_(2); press(i, 0); await frames_(1); }", index
        )

    def push(self, right: float, forward: float, up: float, fine: bool = False) -> None:
        self._page.evaluate(
            "([axes, index, value]) => { pad.axes = axes; press(index, value); }",
            [[right, -forward, 0, -up], FINE_BUTTON, 1 if fine else 0],
        )


class Thumbs:
    """Two thumbs on a touch screen; menus are tapped (see `TappingTrainee`)."""

    def __init__(self, page: Page):
        self._page = page
        self._screen = page.context.new_cdp_session(page)
        self._thumbs: dict[int, tuple[float, float]] = {}

    def tap(self, control: str) -> None:
        self._page.tap(f"#touch-controls [data-control={control}]")

    def push(self, right: float, forward: float, up: float, fine: bool = False) -> None:
        button = self._page.query_selector("#touch-controls [aria-pressed]:not([data-toggle])")
        if fine != (button.get_attribute("aria-pressed") == "true"):
            self._lift(0)
            self._lift(1)
            button.tap()
        for thumb, across, along in ((0, right, forward), (1, 0.0, up)):
            if across or along:
                self._put(thumb, across, along)
            else:
                self._lift(thumb)

    def _put(self, thumb: int, across: float, along: float) -> None:
        box = self._page.query_selector_all("#touch-controls .stick")[thumb].bounding_box()
        if box is None:
            # A menu has opened.
            return
        radius = box["width"] / 2
        is_new = thumb not in self._thumbs
        middle = box["x"] + radius, box["y"] + radius
        if is_new:
            self._thumbs[thumb] = middle
            self._send("touchStart")
        self._thumbs[thumb] = middle[0] + across * radius, middle[1] - along * radius
        self._send("touchMove")

    def _lift(self, thumb: int) -> None:
        if self._thumbs.pop(thumb, None) is not None:
            self._send("touchEnd")

    def _send(self, kind: str) -> None:
        points = [{"id": thumb, "x": x, "y": y} for thumb, (x, y) in self._thumbs.items()]
        self._screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


KEPT_STICK_SHARE = 0.4
"""A stick is released if its part of the movement is smaller than this share of the other's."""


class PageMouse:
    """The mouse alone: it clicks on menus and hints, and drags one of the sticks at a time."""

    def __init__(self, page: Page):
        self._page = page
        self._dragged: str | None = None
        self._was_fine = False
        self._stick = (0.0, 0.0, 0.0)

    def click(self, item: str) -> None:
        """Click on an item of the menu or on a hint, once it is there."""
        target = f"#menu li[data-name='{item}'] button, #hints [data-item='{item}']"
        self._page.wait_for_function(_IS_TARGET, arg=target)
        # The page may redraw the hints at any moment: a click that would miss is repeated.
        self._page.click(target)

    def tap(self, control: str) -> None:
        self.push(0.0, 0.0, 0.0)
        self.click(f"press {control}")

    def push(self, right: float, forward: float, up: float, fine: bool = False) -> None:
        """Drag the stick with the larger part; slow motion is clicked on and off."""
        is_level = self._is_level(math.hypot(right, forward), abs(up))
        across, along = (right, forward) if is_level else (0.0, up)
        wanted = ("first", "last")[not is_level] if across or along else None
        if self._dragged is not None and (wanted, fine) != (self._dragged, self._was_fine):
            self._page.mouse.up()
            self._dragged = None
        if wanted is None or (self._dragged is None and not self._seize(wanted, fine)):
            return
        # While a stick is dragged, the page is asked nothing else: each answer may take long.
        x, y, radius = self._stick
        self._page.mouse.move(x + across * radius, y - along * radius)

    def _is_level(self, level: float, upright: float) -> bool:
        """Return whether the first stick is dragged; changing sticks takes long."""
        if self._dragged == "first":
            return level >= KEPT_STICK_SHARE * upright
        if self._dragged == "last":
            return upright < KEPT_STICK_SHARE * level
        return level >= upright

    def _seize(self, stick: str, fine: bool) -> bool:
        """Take hold of the first or the last stick; return whether it is shown."""
        if fine != self._is_slow and self._page.query_selector(_FINE_HINT) is not None:
            # Some steps of the tutorial lack this hint, and one may begin at this moment.
            with suppress(Error):
                self.click("press fine")
                self._page.wait_for_function(_SLOW_IS, arg="on" if fine else "off")
        sticks = self._page.query_selector_all("#touch-controls .stick")
        box = sticks[0 if stick == "first" else 1].bounding_box()
        if box is None:
            # A menu has opened.
            return False
        radius = box["width"] / 2
        self._stick = box["x"] + radius, box["y"] + radius, radius
        self._page.mouse.move(*self._stick[:2])
        self._page.mouse.down()
        self._dragged, self._was_fine = stick, fine
        return True

    @property
    def _is_slow(self) -> bool:
        # Early in the tutorial there is no such hint.
        texts = self._page.locator(_FINE_HINT).all_inner_texts()
        return any(text.endswith("on") for text in texts)


class Controllers:
    """The emulated headset's controllers."""

    def __init__(self, page: Page):
        self._page = page

    def tap(self, control: str) -> None:
        if control in STEPS:
            self._page.evaluate(
                """async ([x, y]) => {
                  device.controllers.left.updateAxes("thumbstick", x, y); await frames_(2);
                  device.controllers.left.updateAxes("thumbstick", 0, 0); await frames_(1); }""",
                list(STEPS[control]),
            )
            return
        self._page.evaluate(
            """async ([hand, button]) => {
              device.controllers[hand].updateButtonValue(button, 1); await frames_(2);
              device.controllers[hand].updateButtonValue(button, 0); await frames_(1); }""",
            list(CONTROLLER_BUTTONS[control]),
        )

    def push(self, right: float, forward: float, up: float, fine: bool = False) -> None:
        self._page.evaluate(
            """([x, y, z, fine]) => {
              device.controllers.left.updateAxes("thumbstick", x, y);
              device.controllers.right.updateAxes("thumbstick", 0, z);
              device.controllers.left.updateButtonValue("trigger", fine); }""",
            [right, -forward, -up, 1 if fine else 0],
        )

    def point_at(self, name: str) -> None:
        """Point at a part of a panel by that name with the right hand, and pull the trigger."""
        self._page.evaluate(_POINT, name)

    def grab(self, is_held: bool) -> None:
        """Hold the right grip, or release it."""
        self._page.evaluate(
            """async (value) => {
              device.controllers.right.updateButtonValue("squeeze", value); await frames_(2); }""",
            1 if is_held else 0,
        )

    def move(self, right: float, up: float, back: float) -> list[float]:
        """Move the right hand by so much, m, in the headset's space; return it in World."""
        return self._page.evaluate(_MOVE, [right, up, back])


_CARRY = """async ([x, y, z]) => {
  const { rig } = page.headset.placement;
  const { right } = device.hands;
  const by = rig.position.clone().set(x, z, -y);
  by.applyQuaternion(rig.getWorldQuaternion(rig.quaternion.clone()).invert());
  const { x: a, y: b, z: c } = right.position;
  right.position.set(a + by.x, b + by.y, c + by.z);
  await frames_(2);
}"""
_PINCH = """async (value) => {
  const { right } = device.hands;
  if (value > 0) {
    const { x, y, z } = device.position;
    right.position.set(x + 0.2, y - 0.4, z - 0.2);
    right.quaternion.set(-0.7071, 0, 0, 0.7071);
    await frames_(2);
  }
  right.updatePinchValue(value);
  await frames_(3);
}"""


class TrackedHands:
    """The emulated headset's tracked right hand, which only points, pinches and moves."""

    def __init__(self, page: Page):
        self._page = page
        page.evaluate("device.primaryInputMode = 'hand'; frames_(3)")

    def choose(self, name: str) -> None:
        """Point at a part of a panel, and pinch."""
        self._page.evaluate(_POINT, name)

    def tap(self, control: str) -> None:
        """Pinch at the hint of a control."""
        self.choose(f"press {control}")

    def pinch(self, is_held: bool) -> None:
        """Pinch in the air, pointing at the floor, or release."""
        self._page.evaluate(_PINCH, 1 if is_held else 0)

    def carry(self, by: Sequence[float]) -> None:
        """Move the hand by so much, (3,) World, m."""
        self._page.evaluate(_CARRY, list(map(float, by)))

    def push(self, *_sticks: float) -> None:
        """Release: hands have no sticks."""
        self.pinch(False)
