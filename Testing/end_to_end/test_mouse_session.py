"""The window by the mouse alone: the ID, the trial run, the sticks, Touch and the menu."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from contextlib import suppress

import pytest

from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import StreamTrainee
from Testing.end_to_end.virtual_display import VirtualMouse
from Testing.end_to_end.window_process import TIMEOUT_S, WindowProcess, wait_until

# A window that the processor draws needs the machine to itself.
pytestmark = pytest.mark.soak

SIZE = (960, 540)
SPEED = "0.4"
"""Simulated seconds per second: a stick is released in time, however late a picture is."""
SCROLLED_S = 0.5
BOX = """(item) => {
  const found = document.querySelector(`[data-item="${item}"], li[data-name="${item}"]`);
  const isShown = found !== null && found.getClientRects().length > 0;
  return isShown ? found.getBoundingClientRect().toJSON() : null;
}"""
# The middle of the menu, and between which heights it is in sight: a low window scrolls it whole.
MENU = """() => {
  const menu = document.getElementById("menu");
  const { left, top, bottom, width } = menu.getBoundingClientRect();
  const high = (part) => menu.querySelector(part).offsetHeight + 10;
  const lowest = Math.min(bottom, innerHeight) - high(".help");
  return [left + width / 2, Math.max(top, 0) + high("h2"), lowest];
}"""
STICK = """(index) => {
  const box = document.querySelectorAll("#touch-controls .stick")[index].getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2, box.width / 2];
}"""


class WindowMouse:
    """Clicks on what the window shows, and drags one of its sticks at a time."""

    def __init__(self, lab: Lab, window: WindowProcess):
        self._lab, self._window = lab, window
        self._mouse = VirtualMouse(lab.display)
        # Where the page begins in the display: its window may have a frame.
        frame = "[screenX + outerWidth - innerWidth, screenY + outerHeight - innerHeight]"
        self._corner = window.page.evaluate(frame)
        self._dragged: int | None = None

    def click(self, item: str) -> None:
        """Click on an item of the menu or on a hint, once it is shown."""
        wait_until(lambda: self._moves_onto(item), f"{item} in the window")
        self._mouse.hold(True)
        self._mouse.hold(False)

    def tap(self, control: str) -> None:
        self.push(0.0, 0.0, 0.0)
        self.click(f"press {control}")

    def push(self, right: float, forward: float, up: float, fine: bool = False) -> None:
        """Drag the stick of the larger part; slow motion is clicked on and off."""
        is_level = math.hypot(right, forward) >= abs(up)
        across, along = (right, forward) if is_level else (0.0, up)
        wanted = int(not is_level) if across or along else None
        if wanted is not None and fine != self._is_slow:
            self._let_go()
            self.click("press fine")
            wait_until(lambda: self._is_slow == fine, "slow motion")
        if wanted != self._dragged:
            self._let_go()
        if wanted is None:
            return
        wait_until(lambda: self._stick(wanted)[2] > 0.0, "a stick in the window")
        x, y, radius = self._stick(wanted)
        if self._dragged is None:
            self._move(x, y)
            self._mouse.hold(True)
            self._dragged = wanted
        self._move(x + radius * across, y - radius * along)

    def close(self) -> None:
        self._mouse.close()

    @property
    def _is_slow(self) -> bool:
        hints = self._lab.view.screen.hints
        return any(hint.item == "press fine" and hint.action == "on" for hint in hints)

    def _stick(self, index: int) -> tuple[float, float, float]:
        """Return the middle and the radius of a stick, all 0 until the window has drawn it."""
        return self._window.page.evaluate(STICK, index)

    def _let_go(self) -> None:
        if self._dragged is not None:
            self._mouse.hold(False)
            self._dragged = None

    def _move(self, x: float, y: float) -> None:
        self._mouse.move(self._corner[0] + round(x), self._corner[1] + round(y))

    def _moves_onto(self, item: str) -> bool:
        """Move onto an item if it is in sight; a menu may be drawn anew meanwhile."""
        place = self._place(item) if self._is_in_sight(item) else None
        if place is not None:
            self._move(*place)
        return place is not None

    def _is_in_sight(self, item: str) -> bool:
        """Return whether an item can be clicked; one out of the menu's sight is scrolled to."""
        place = self._place(item)
        if place is None:
            return False
        x, top, bottom = self._window.page.evaluate(MENU)
        if item.startswith("press") or top < place[1] < bottom:
            return True
        self._move(x, (top + bottom) / 2)
        self._mouse.turn_wheel(is_down=place[1] >= bottom)
        # The page scrolls smoothly.
        time.sleep(SCROLLED_S)
        return False

    def _place(self, item: str) -> tuple[float, float] | None:
        """Return the middle of an item's button; None if it is not shown."""
        box = self._window.page.evaluate(BOX, item)
        return None if box is None else (box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)


class ClickingInWindow(StreamTrainee):
    """Goes through the menus by clicks."""

    # A click before the window has drawn the item chooses nothing.
    again_s = 10.0

    def choose(self, item: str) -> None:
        """Click on an item, which leads to another menu."""
        before = self.menu_name
        self._until_clicked(item, lambda: self.menu_name != before)

    def show_sticks(self) -> None:
        """Have the sticks shown."""
        if not self.view.screen.has_sticks:
            self._until_clicked("press sticks", lambda: self.view.screen.has_sticks)

    def _until_clicked(self, item: str, is_done: Callable[[], bool]) -> None:
        give_up = time.monotonic() + TIMEOUT_S
        while time.monotonic() < give_up:
            self.hands.click(item)
            with suppress(AssertionError):
                wait_until(is_done, f"after {item}", self.again_s)
                return
        raise AssertionError(f"clicks on {item} did nothing; the screen: {self.view.screen}")


def enter_id(trainee):
    """Click from the start menu to the menu of tasks, with the ID P7."""
    trainee.until_menu("start")
    for item in ("train", "skip", "next", "clicked", "row 1", "P", "row 3", "7", "done"):
        trainee.choose(item)
    assert trainee.value("trainee") == "P7"


def begin(lab, window, trainee, task):
    """Click on a task, and have the sticks shown once the window shows it."""
    trainee.choose(task)
    trainee.until(lambda: lab.view.scene["task"] == task, "the scene")
    # Until the window has loaded the scene, it shows the previous menu.
    window.wait_for_tick(lab.view.state["tick"])
    trainee.show_sticks()


def test_the_mouse_alone_enters_an_id_drives_the_arm_presses_touch_and_opens_the_menu(tmp_path):
    with Lab(tmp_path, "--speed", SPEED, "--seed", "8", "--no-gamepad") as lab:
        window = lab.open_window("window", SIZE)
        mouse = WindowMouse(lab, window)
        trainee = ClickingInWindow(lab.view, mouse)
        enter_id(trainee)
        begin(lab, window, trainee, "trial-run")
        start = trainee.tip.copy()
        mouse.push(0.0, 0.0, 1.0)
        trainee.until(lambda: trainee.tip[2] > start[2] + 0.01, "a move up")
        mouse.push(1.0, 0.0, 0.0)
        trainee.until_moved()
        mouse.push(0.0, 0.0, 0.0)
        trainee.until_still()
        assert lab.view.holder == "mouse"
        mouse.click("press touch")
        trainee.until(lambda: trainee.refused == 1, "the refusal of a touch in the air")
        trainee.press("menu", lambda: trainee.menu is not None, "the menu")
        trainee.choose("resume")
        window.wait_for_pictures()
        mouse.close()
