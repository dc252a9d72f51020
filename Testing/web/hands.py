"""What a trainee works the page with: keys, a gamepad that the browser reads, XR controllers."""

from __future__ import annotations

from playwright.sync_api import Page

KEYS = {
    "accept": "Enter",
    "back": "Escape",
    "touch": "Space",
    "undo": "Backspace",
    "camera": "KeyC",
    "menu": "KeyM",
    "up": "ArrowUp",
    "down": "ArrowDown",
}
BUTTONS = {"accept": 0, "touch": 0, "back": 1, "undo": 1, "camera": 3, "menu": 9}
BUTTONS |= {"up": 12, "down": 13, "left": 14, "right": 15}
CONTROLLER_BUTTONS = {
    "accept": ("right", "a-button"),
    "touch": ("right", "a-button"),
    "back": ("right", "b-button"),
    "undo": ("right", "b-button"),
    "camera": ("left", "y-button"),
    "menu": ("left", "x-button"),
}
STEPS = {"up": (0, -1), "down": (0, 1), "left": (-1, 0), "right": (1, 0)}


class PageKeys:
    """The keyboard."""

    def __init__(self, page: Page):
        self._page = page

    def tap(self, control: str) -> None:
        self._page.keyboard.press(KEYS[control])


class BrowserPad:
    """A gamepad in the W3C's standard layout."""

    def __init__(self, page: Page):
        self._page = page

    def tap(self, control: str) -> None:
        index = BUTTONS[control]
        self._page.evaluate(
            "async (i) => { press(i, 1); await frames_(2); press(i, 0); await frames_(1); }", index
        )

    def push(self, right: float, forward: float, up: float) -> None:
        self._page.evaluate("(axes) => { pad.axes = axes; }", [right, -forward, 0, -up])


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

    def push(self, right: float, forward: float, up: float) -> None:
        self._page.evaluate(
            """([x, y, z]) => {
              device.controllers.left.updateAxes("thumbstick", x, y);
              device.controllers.right.updateAxes("thumbstick", 0, z); }""",
            [right, -forward, -up],
        )
