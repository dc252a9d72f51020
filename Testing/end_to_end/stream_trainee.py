"""A trainee who knows only what every view receives, and uses real input devices."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from contextlib import suppress
from itertools import accumulate
from typing import Protocol

import numpy as np
from playwright.sync_api import Page
from scipy.spatial.transform import Rotation

from rastrainer.igtl.client import Client
from rastrainer.json_records import record_from_json
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.flow_presenter import PICTURE_GRACE_S
from rastrainer_simulator.flow.session.chosen_trial import FIRST_ID
from rastrainer_simulator.presentation.screen import Menu, Screen
from rastrainer_simulator.teleoperation.steering import camera_axes
from Testing.end_to_end.onto_skin import lowered
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.net.views.served import ViewClient

TIMEOUT_S = 120.0
LIFT_M = 0.035
"""Height to which the tip is lifted before it is carried to the next fiducial."""
COARSE_M, FINE_M = 0.03, 0.01
"""Nearer than this the sticks are pushed less."""
LEAST_PUSH, LEAST_FINE_PUSH = 0.35, 0.7
"""Beyond the sticks' dead zone."""
LONGEST_WAY_S = 4.0
SINK_M = 0.003
"""Depth below the skin at which the sticks aim, so that the tip rests on it."""
ON_POINT_M, NEAR_M = 0.002, 0.008
"""Distance at which the tip is stopped, and how far from there it may come to rest."""
LONGEST_TOUCH_S = 600.0
"""For many attempts: on a busy machine they are clumsy."""
STILL_STATES = 10
"""The arm is at rest after this number of equal states in a row."""
TRAINEE = "P7"
SETTLED_STATES = 20
"""The focus has settled after this number of states in a row: a third of a second."""
LEAVES = {"trial": "abort", "abort": "abort", "complete": "abort", "result": "menu"}
"""Each menu's item that leads to the start."""


class Hands(Protocol):
    """The input device of a trainee."""

    def tap(self, control: str) -> None:
        """Press a control for a moment."""

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        """Push the sticks, −1…1."""


class WatchingView:
    """A second view that records the messages that all views receive.

    Attributes:
        state, screen, scene: the latest.
        trace: the latest news of a trace.
        events: all, in order.
    """

    def __init__(self, client: ViewClient):
        self.state: dict | None = None
        self.scene: dict | None = None
        self.trace: dict = {"next": None}
        self.screen = Screen()
        self.events: list[dict] = []
        self._client = client
        self._bodies = client.join(kind="page", device="watcher")["bodies"]
        self._has_state = threading.Condition()
        threading.Thread(target=self._watch, daemon=True).start()
        wait_until(lambda: self.state is not None and self.scene is not None, "the stream")

    @property
    def menu_name(self) -> str | None:
        """The open menu's name, read once: another thread replaces the screen."""
        menu = self.screen.menu
        return None if menu is None else menu.name

    def pose(self, body: str) -> np.ndarray:
        """Return (4, 4) float, to World in m."""
        pose = self.state["poses"][self._bodies.index(body)]
        matrix = np.eye(4)
        matrix[:3, :3] = Rotation.from_quat(pose[3:]).as_matrix()
        matrix[:3, 3] = pose[:3]
        return matrix

    def next_state(self) -> None:
        """Wait for the next state."""
        with self._has_state:
            assert self._has_state.wait(TIMEOUT_S), "the stream has ended"

    def _watch(self) -> None:
        with suppress(Exception):
            while True:
                message = self._client.next()
                if message["type"] == "screen":
                    self.screen = record_from_json(Screen, message["screen"], "The screen")
                elif message["type"] == "event":
                    self.events.append(message)
                elif message["type"] == "trace":
                    self.trace = message
                elif message["type"] in ("state", "scene"):
                    setattr(self, message["type"], message)
                    with self._has_state:
                        self._has_state.notify_all()


class Trainee:
    """Goes through menus by their names, and to fiducials by the sticks, in their order.

    Attributes:
        view: what the trainee sees.
        hands: the input device.
        again_s: time after which a press without an effect is repeated. Every press is seen in the
            next picture, however late: a repeated slow press would count twice.
    """

    again_s = 60.0

    def __init__(self, view: WatchingView, hands: Hands):
        self.view = view
        self.hands = hands

    @property
    def menu(self) -> Menu | None:
        return self.view.screen.menu

    @property
    def menu_name(self) -> str | None:
        return self.view.menu_name

    @property
    def touched(self) -> int:
        return len(self.view.state["touched"])

    @property
    def refused(self) -> int:
        return sum(event["kind"] == "error" for event in self.view.events)

    @property
    def warnings(self) -> list[str]:
        return [warning.text for warning in self.view.screen.warnings]

    @property
    def tip(self) -> np.ndarray:
        return self.view.pose("tool")[:3, 3]

    def until(self, condition: Callable[[], bool], what: str) -> None:
        give_up = time.monotonic() + TIMEOUT_S
        while not condition():
            assert time.monotonic() < give_up, f"{what} never came; the screen: {self.view.screen}"
            self.view.next_state()

    def until_warned(self, text: str, is_warned: bool = True) -> None:
        """Wait until the screen shows a warning of that text, or no longer."""
        self.until(lambda: (text in self.warnings) is is_warned, text)

    def until_moved(self) -> None:
        """Wait until the tip has moved by 10 mm."""
        start = self.tip.copy()
        self.until(lambda: np.linalg.norm(self.tip - start) > 0.01, "a move of the arm")

    def until_still(self) -> None:
        """Wait until the tip is at rest."""
        places: list[list[float]] = []

        def stands() -> bool:
            places.append(self.tip.tolist())
            return places[-STILL_STATES:] == [places[-1]] * STILL_STATES

        self.until(stands, "the arm's stop")

    def until_menu(self, name: str | None) -> None:
        """Wait until a menu of that name is open, or none."""
        self.until(lambda: self.menu_name == name, f"the menu {name}")

    def press(self, control: str, is_done: Callable[[], bool], what: str) -> None:
        """Press a control, and wait until it has an effect."""
        give_up = time.monotonic() + TIMEOUT_S
        while not is_done():
            assert time.monotonic() < give_up, f"{what} never came; the screen: {self.view.screen}"
            self.hands.tap(control)
            with suppress(AssertionError):
                wait_until(is_done, what, self.again_s)

    def choose(self, item: str) -> None:
        """Move the focus to an item and accept it; it leads to another menu."""
        self.focus(item)
        before = self.menu_name
        self.press("accept", lambda: self.menu_name != before, f"after {item}")

    def focus(self, item: str) -> None:
        """Move the focus to an item, and see that it stays there.

        A tapped key is held until the next picture: if that takes long, the focus moves on.
        """
        settled = 0
        while settled < SETTLED_STATES:
            self._move_focus(item)
            self.view.next_state()
            settled = settled + 1 if self.menu.focus == item else 0

    def _move_focus(self, item: str) -> None:
        names = [each.name for each in self.menu.items if each.kind != "axis"]
        assert item in names, f"{self.menu.name} has {names}"
        # A menu that has opened by itself ignores input for a moment.
        self.until(lambda: self.menu.focus, "a focus")
        while (before := self.menu.focus) != item:
            direction = "down" if names.index(item) > names.index(before) else "up"
            self.press(direction, lambda b=before: self.menu.focus != b, "another focus")

    def value(self, item: str) -> str:
        """Return an item's value."""
        return next(each.value for each in self.menu.items if each.name == item)

    def place_of(self, label: str) -> np.ndarray:
        """Return where a fiducial is, (3,) float, World, m."""
        head = self.view.pose("head")
        return head[:3, :3] @ self.view.scene["fiducials"][label] + head[:3, 3]

    @property
    def head_center(self) -> np.ndarray:
        """The middle of all fiducials lies within the head."""
        places = [self.place_of(label) for label in self.view.scene["fiducials"]]
        return np.mean(places, axis=0)

    def begin_task(self, task: str) -> None:
        """Choose a task in the experiment's menu, and wait until its scene is loaded.

        It is built once the trial has begun, the first time on a machine: the trial waits until
        its view has drawn it.
        """
        self.choose(task)
        self.until_menu(None)
        self.until(lambda: self.view.scene["task"] == task, f"the scene of {task}")
        self.until_running()

    def until_running(self) -> None:
        """Wait until the trial no longer waits for its picture."""
        since = [self.view.state["timeS"]]

        def has_run() -> bool:
            now = self.view.state
            if now["phase"] != "running" or self.menu is not None:
                since[0] = now["timeS"]
            return now["timeS"] - since[0] > 2.0 * PICTURE_GRACE_S

        self.until(has_run, "the trial with its picture")

    def approach(self, label: str, near_m: float) -> None:
        """Carry the tip over the head to a place above a fiducial."""
        self.go_above(self.place_of(label), near_m)

    def go_above(self, point: np.ndarray, near_m: float) -> None:
        """Carry the tip over the head to above a place, (3,) World, m, clear of the skin."""
        center = self.head_center
        outward = (point - center) / np.linalg.norm(point - center)
        start = self.tip - center
        height = LIFT_M + max(np.linalg.norm(point - center), np.linalg.norm(start))
        first = start / np.linalg.norm(start)
        steps = max(2, int(np.degrees(np.arccos(np.clip(first @ outward, -1, 1))) / 20))
        for share in np.linspace(0.0, 1.0, steps):
            between = (1.0 - share) * first + share * outward
            self.steer_to(center + height * between / np.linalg.norm(between), near_m)

    def touch(self, label: str) -> None:
        """Go to a fiducial and record it."""
        self.approach(label, 0.03)
        self.press_on(label)

    def press_on(self, label: str) -> None:
        """Record the fiducial under the tip; after a miss, approach from above again."""
        kept, give_up = self.touched, time.monotonic() + LONGEST_TOUCH_S
        while time.monotonic() < give_up:
            if self.lower_onto(label):
                self._tap_touch(label)
            if self.touched > kept:
                return
            self.approach(label, 0.02)
        raise AssertionError(f"touch {label} never came; the screen: {self.view.screen}")

    def lower_onto(self, label: str) -> bool:
        """Lower the tip onto the fiducial under it; return whether it came to rest near it."""
        point, center = self.place_of(label), self.head_center
        outward = (point - center) / np.linalg.norm(point - center)
        self.steer_to(point + 0.012 * outward, 0.008)
        self.steer_to(point, ON_POINT_M, fine=True)
        self.sink_onto_skin(point - SINK_M * outward)
        self.hands.push(0.0, 0.0, 0.0, False)
        self.until_still()
        return bool(np.linalg.norm(point - self.tip) < NEAR_M)

    def sink_onto_skin(self, below: np.ndarray) -> None:
        """Push the tip slowly toward a place below the skin (3,) World, m, until it is on it."""
        axes, give_up = self._stick_axes(), self.view.state["timeS"] + LONGEST_WAY_S
        while self.view.state["proximity"] != "contact" and self.view.state["timeS"] < give_up:
            away = below - self.tip
            wanted = LEAST_FINE_PUSH * (axes @ away) / np.linalg.norm(away)
            self.hands.push(*wanted.tolist(), True)
            self.view.next_state()

    def _tap_touch(self, label: str) -> None:
        """Press "touch" and wait until it counts or is refused."""
        kept, refused = self.touched, self.refused
        self.hands.tap("touch")
        with suppress(AssertionError):
            wait_until(
                lambda: self.touched > kept or self.refused > refused,
                f"touch {label}",
                self.again_s,
            )

    def steer_to(self, place: np.ndarray, near: float, fine: bool = False) -> None:
        """Push the sticks toward a place (3,) World, m, until the tip is near it."""
        if self.menu_name == "trial":
            # The simulator pauses if a busy machine keeps the window from drawing.
            self.choose("resume")
        slow, least = (FINE_M, LEAST_FINE_PUSH) if fine else (COARSE_M, LEAST_PUSH)
        give_up = self.view.state["timeS"] + LONGEST_WAY_S
        while np.linalg.norm(away := place - self.tip) > near:
            if self.view.state["timeS"] > give_up:
                break
            far = float(np.linalg.norm(away))
            wanted = self._stick_axes() @ away / far * max(least, min(1.0, far / slow))
            self.hands.push(*wanted.tolist(), fine)
            self.view.next_state()

    def _stick_axes(self) -> np.ndarray:
        """Return right, forward and up in the picture, as rows, (3, 3) float."""
        camera = self.view.state["view"]
        line = np.subtract(camera["focalPoint"], camera["position"])
        axes = camera_axes(tuple(line.tolist()), tuple(camera["viewUp"]))
        return np.array([axes.right, axes.forward, axes.up])

    def go_home(self) -> None:
        """Go to the start menu from where the last trainee stopped."""
        while self.menu_name != "start":
            before = self.menu
            if before is None:
                self.press("menu", lambda: self.menu is not None, "the menu")
            elif before.name in LEAVES:
                self.choose(LEAVES[before.name])
            else:
                self.go_back()

    def go_back(self) -> None:
        """Go back to the menu before."""
        before = self.menu
        self.press("back", lambda: self.menu != before, f"before {before.name}")

    def go_to_experiment(self) -> None:
        """Go from where the last trainee stopped to the choice of head and task."""
        self.go_home()
        self.choose("train")
        while self.menu_name != "experiment":
            self.choose("skip" if self.menu_name == "introduction" else "next")

    def play_to_result(self) -> None:
        """Touch all fiducials, register them, and read the score."""
        self.touch_all()
        self.register()
        self.until_menu("result")
        assert self.menu.facts[0].label == "Score"

    def begin(self, task: str, page: Page | None = None) -> None:
        """Go from the start menu into a task.

        The ID is typed on the page, or without a page on the simulator's keyboard.
        """
        self.go_to_experiment()
        if self.value("trainee") in ("", FIRST_ID):
            self.type_id(page)
        self.begin_task(task)
        self.until(lambda: self.view.state["phase"] == "running", "the trial")

    def type_id(self, page: Page | None) -> None:
        """Type the ID on the page, or without a page on the simulator's keyboard."""
        if page is not None:
            self.focus("trainee")
            page.wait_for_selector("#menu input:focus")
            for typed in accumulate(TRAINEE):
                page.keyboard.press(typed[-1])
                self.until(lambda typed=typed: self.value("trainee") == typed, "the ID")
                # A field forgets text that is answered too late.
                shown = f"document.querySelector('#menu input:focus')?.value === '{typed}'"
                wait_until(lambda shown=shown: page.evaluate(shown), "the ID on the page")
            return
        self.choose("trainee")
        self.press("accept", lambda: self.menu.facts[0].value.startswith("A"), "the letter A")
        self.choose("done")

    def set_choice(self, item: str, value: str) -> None:
        """Turn a choice of the menu until it shows a value."""
        self.focus(item)
        while (before := self.value(item)) != value:
            self.press("right", lambda b=before: self.value(item) != b, f"another {item}")

    def resume(self) -> None:
        """Resume a trial that was paused."""
        self.until_menu("trial")
        self.choose("resume")
        self.until(lambda: self.view.state["phase"] == "running", "the trial again")

    def touch_all(self, most: int = 15) -> None:
        """Touch the remaining points, up to `most` in all."""
        while self.touched < most:
            label = self.view.state["next"]
            self.approach(label, 0.02)
            self.press_on(label)

    def register(self) -> None:
        """Have the touched points registered."""
        self.press("touch", lambda: self.menu is not None, "the choice")
        self.choose("register")


class CarriedTrainee(Trainee):
    """Is quick: carries the tip by commands."""

    def __init__(self, view: WatchingView, hands: object, client: Client):
        super().__init__(view, hands)
        self.client = client

    def steer_to(self, place: np.ndarray, near: float, fine: bool = False) -> None:  # noqa: ARG002
        if self.menu is not None:
            # A machine that is too busy to draw counts as a headset that is not worn.
            self.choose("resume")
        self.send_tip((MM_PER_M * place).tolist())
        give_up = self.view.state["timeS"] + 4.0
        while np.linalg.norm(place - self.tip) > 0.002 and self.view.state["timeS"] < give_up:
            self.view.next_state()

    def press_on(self, label: str) -> None:
        """Record the fiducial under the tip."""
        self.lower_onto(label)
        kept = self.touched
        self.press("touch", lambda: self.touched > kept, f"touch {label}")

    def lower_onto(self, label: str) -> bool:
        """Have the tip lowered onto a fiducial, until it is in contact."""
        place = self.place_of(label)
        self.steer_to(place, 0.002)
        below = lowered(MM_PER_M * place, MM_PER_M * self.head_center)
        self.send_tip(below)
        self.until(lambda: self.view.state["proximity"] == "contact", f"contact at {label}")
        return True

    def send_tip(self, position_mm: list[float], speed_mm_s: float = 400.0) -> None:
        """Have the tip move to a place in World."""
        target = {"positionMm": position_mm, "speedMmS": speed_mm_s}
        reply = self.client.send_command("MoveTipTo", target, timeout=60)
        assert reply.ok, reply.error
