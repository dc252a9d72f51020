"""The window by the mouse alone: the ID, the tutorial, a whole trial, menus and the result."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer.journal.journal_file import read_journal
from rastrainer_simulator.desktop.overlay import Content, Overlay
from rastrainer_simulator.desktop.panels.stick import stick_boxes
from rastrainer_simulator.desktop.picture import own_facts
from rastrainer_simulator.flow.tutorial.steps import TutorialStep
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.net.views.screen import PRESS
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import StreamTrainee
from Testing.end_to_end.view_learner import ViewLearner
from Testing.end_to_end.virtual_display import VirtualMouse
from Testing.end_to_end.window_process import wait_until
from Testing.tutorial_player import TutorialPlayer

# A window that the processor draws wants the machine for itself.
pytestmark = pytest.mark.soak

SIZE = (960, 540)
SPEED = "0.4"
"""Simulated seconds in a second: a stick is let go of in time, however late a picture is."""
GRID_PX, HINTS_PX = 10, 100
RIGHT_BUTTON = 3


class WindowMouse:
    """Clicks on what the window shows, and drags one of its sticks at a time."""

    def __init__(self, lab: Lab):
        self._lab = lab
        self._mouse = VirtualMouse(lab.display)
        self._corner = self._mouse.window_corner(SIZE[0])
        self._dragged: int | None = None

    def click(self, item: str) -> None:
        """Click on an item of the menu or on a hint, once it is shown."""
        found: list[tuple[int, int]] = []
        wait_until(lambda: found.extend(self._places(item)) or found, f"{item} in the window")
        self._move(*found[0])
        self._mouse.hold(True)
        self._mouse.hold(False)

    def turn_view(self, across_px: int) -> None:
        """Drag with the right button, from the middle of the picture."""
        self._move(SIZE[0] / 2, SIZE[1] / 2)
        self._mouse.hold(True, RIGHT_BUTTON)
        self._move(SIZE[0] / 2 + across_px, SIZE[1] / 2)
        self._mouse.hold(False, RIGHT_BUTTON)

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
        box = stick_boxes(SIZE)[wanted]
        radius = box.width / 2
        if self._dragged is None:
            self._move(box.left + radius, box.top + radius)
            self._mouse.hold(True)
            self._dragged = wanted
        self._move(box.left + radius * (1 + across), box.top + radius * (1 - along))

    def close(self) -> None:
        self._mouse.close()

    @property
    def _is_slow(self) -> bool:
        hints = self._lab.view.screen.hints
        return any(hint.item == "press fine" and hint.action == "on" for hint in hints)

    def _let_go(self) -> None:
        if self._dragged is not None:
            self._mouse.hold(False)
            self._dragged = None

    def _move(self, x: float, y: float) -> None:
        self._mouse.move(self._corner[0] + round(x), self._corner[1] + round(y))

    def _places(self, item: str) -> list[tuple[int, int]]:
        """Return the first pixel of a grid at which a click chooses an item; none without one."""
        view, screen = self._lab.view, self._lab.view.screen
        pairing = None if screen.menu is None else view.pairing
        facts = own_facts(screen.language, view.holder, pairing)
        overlay = Overlay(vtkRenderer())
        overlay.show(Content(replace(screen, status=(*screen.status, *facts))), SIZE)
        # Hints are at the lower edge: to look for them everywhere would keep the stream waiting.
        top = SIZE[1] - HINTS_PX if item.startswith(PRESS) else 0
        rows, columns = range(top, SIZE[1], GRID_PX), range(0, SIZE[0], GRID_PX)
        grid = [(x, y) for y in rows for x in columns]
        return list(islice((place for place in grid if overlay.item_at(*place) == item), 1))


class ClickingInWindow(StreamTrainee):
    """Goes through the menus by clicks."""

    # A click before the window has drawn what is clicked chooses nothing.
    again_s = 10.0

    def choose(self, item: str) -> None:
        """Click on an item, which leads to another menu."""
        before = self.menu.name
        self._until_clicked(item, lambda: not self.menu or self.menu.name != before)

    def show_sticks(self) -> None:
        """Have the sticks shown, and wait until the window has them."""
        if not self.view.screen.has_sticks:
            self._until_clicked("press sticks", lambda: self.view.screen.has_sticks)

    def _until_clicked(self, item: str, is_done: Callable[[], bool]) -> None:
        while not is_done():
            self.hands.click(item)
            with suppress(AssertionError):
                wait_until(is_done, f"after {item}", self.again_s)


class LearningHands:
    """Acts again where the window, which draws late, has not been ready for it."""

    def __init__(self, trainee: ClickingInWindow):
        self._trainee, self._mouse = trainee, trainee.hands
        self.turn_view = self._mouse.turn_view

    def tap(self, control: str) -> None:
        """Click on the hint of a control until the screen changes."""
        view = self._trainee.view
        self._mouse.push(0.0, 0.0, 0.0)
        before = view.screen.status, view.screen.menu, view.screen.instruction
        is_done = lambda: (view.screen.status, view.screen.menu, view.screen.instruction) != before  # noqa: E731
        self._trainee._until_clicked(f"press {control}", is_done)

    def push(self, right: float, forward: float, up: float, fine: bool = False) -> None:
        """Drag a stick, and seize it again until the arm has moved."""
        self._mouse.push(right, forward, up, fine)
        if not (right or forward or up):
            return
        start = self._trainee.tip.copy()
        has_moved = lambda: float(np.linalg.norm(self._trainee.tip - start)) > 0.001  # noqa: E731
        while not has_moved():
            with suppress(AssertionError):
                wait_until(has_moved, "a move", self._trainee.again_s)
                return
            self._mouse.push(0.0, 0.0, 0.0)
            self._mouse.push(right, forward, up, fine)


class MouseLearner(ViewLearner):
    """Drags with the right button, until the view has turned."""

    def __init__(self, trainee: ClickingInWindow):
        super().__init__(trainee)
        self.hands = LearningHands(trainee)

    def turn_view(self):
        before = self.screen.status
        self.hands.turn_view(150)
        self.until(lambda: self.screen.status != before, "a turn of the view")


def enter_id(trainee):
    """Click from the start menu to that of the tasks, with the ID P7."""
    trainee.until_menu("start")
    for item in ("train", "skip", "next", "clicked", "row 1", "P", "row 3", "7", "done"):
        trainee.choose(item)
    assert trainee.value("trainee") == "P7"


def begin(lab, window, trainee, item):
    """Click on a task or the tutorial, and have the sticks shown once the window shows it."""
    trainee.choose(item)
    trainee.until(lambda: lab.view.scene["task"] == "trial-run", "the scene")
    # Until the window has loaded the scene, it shows the menu before.
    window.wait_for_tick(lab.view.state["tick"])
    trainee.show_sticks()


def test_the_mouse_alone_does_the_tutorial_touches_a_whole_trial_and_reads_its_result(tmp_path):
    rules = {"order": "fixed", "tutorial": "required"}
    with Lab(tmp_path, "--speed", SPEED, "--seed", "8", "--no-gamepad", **rules) as lab:
        window = lab.open_window("window", "--size", "{}x{}".format(*SIZE), "--quality", "low")
        mouse = WindowMouse(lab)
        trainee = ClickingInWindow(lab.view, mouse)
        enter_id(trainee)
        begin(lab, window, trainee, "tutorial")
        player = TutorialPlayer(MouseLearner(trainee), SourceKind.MOUSE)
        player.play()
        assert TutorialStep.GUIDED in dict(player.read)
        trainee.until_menu("tutorial-done")
        begin(lab, window, trainee, "trial-run")
        for number in range(1, 16):
            trainee.touch(str(number))
        trainee.press("touch", lambda: trainee.menu is not None, "the end of the task")
        trainee.choose("register")
        trainee.until_menu("result")
        assert trainee.menu.facts[0].label == "Score"
        journals = [read_journal(path) for path in lab.records.glob("*.journal")]
        (journal,) = journals
        assert len(list(journal.of_kind("touch"))) == 15
        assert {entry["operator"] for entry in journal.of_kind("input")} <= {"mouse", ""}
        mouse.close()


def test_the_mouse_alone_enters_an_id_drives_the_arm_presses_touch_and_opens_the_menu(tmp_path):
    with Lab(tmp_path, "--speed", SPEED, "--seed", "8", "--no-gamepad") as lab:
        window = lab.open_window("window", "--size", "{}x{}".format(*SIZE), "--quality", "low")
        mouse = WindowMouse(lab)
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
        window.wait_for_frames()
        mouse.close()
