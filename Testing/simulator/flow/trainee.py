"""Trainees at a presenter, by keys, gamepad or mouse: they read the screen and steer the tool."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

import numpy as np

from rastrainer.commands import check_arguments
from rastrainer.protocol import Phase, Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.presentation.messages import Feedback, Hello
from rastrainer_simulator.presentation.presenter import Control
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.state import TouchStage
from rastrainer_simulator.teleoperation.steering import camera_axes
from rastrainer_simulator.vectors import dot, subtract
from Testing.simulator.lock_step import PATIENCE_S, LockStep

RATE_HZ = 62.5
"""Rate of a trainee's control loop, which ticks as often as a view is drawn and costs a quarter."""
STEP_S = 1.0 / RATE_HZ
MAX_STEPS = 5_000
SINK_M = 0.003
"""How far below the skin the sticks push for, so that the tip comes to rest on it."""
ATTEMPTS = 3
"""How often to approach a fiducial until the ring on it is green."""
SHORT_PUSHES = 40
LIFT_M = 0.035
"""How far the tip is taken off the skin before it is carried to the next fiducial."""


class Watcher:
    """Records everything that a presenter sends."""

    def __init__(self, presenter):
        self.screens, self.feedbacks, self.controls = [], [], []
        kept = {Screen: self.screens, Feedback: self.feedbacks, Control: self.controls}
        presenter.updates.add(lambda news: kept[type(news)].append(news))

    @property
    def kinds(self):
        return [feedback.kind for feedback in self.feedbacks]


class Trainee:
    """Goes through menus by their names, and to fiducials by the sticks of its hands.

    In a step of `step_s` seconds the presenter advances, and the loop ticks `ticks_a_step` times.
    """

    step_s, ticks_a_step = STEP_S, 1

    def __init__(self, loop, presenter, make_hands, advance: Callable[[float], None] | None = None):
        self.loop, self.presenter, self._advance = loop, presenter, advance or presenter.advance
        self.watcher = Watcher(presenter)
        self._lock_step = LockStep(loop)
        self.hands = make_hands(self)

    def close(self) -> None:
        self._lock_step.free()

    @property
    def menu(self):
        return self.presenter.screen.menu

    @property
    def state(self):
        return self.loop.latest

    @property
    def touched(self) -> int:
        """The number of touches that the views show, in the trial or in the tutorial."""
        return len(self.presenter.shown.latest.training.touches)

    def step(self, count: int = 1) -> None:
        """Advance the presenter by `count` steps, and the loop with it."""
        for _ in range(count):
            self._advance(self.step_s)
            self._lock_step.tick(self.ticks_a_step)

    def until(self, condition: Callable[[], bool], what: str = "it") -> None:
        """Step until a condition is true."""
        give_up = None
        steps = 0
        while not condition():
            self.step()
            steps += 1
            if steps > MAX_STEPS:
                # What must be on the disk before it is shown takes the disk's own time.
                time.sleep(0.005)
                give_up = give_up or time.monotonic() + PATIENCE_S
                assert time.monotonic() < give_up, f"no {what}; the screen: {self.presenter.screen}"

    def until_menu(self, name: str | None) -> None:
        """Step until a menu of that name is open, or none."""
        shown = lambda: None if self.menu is None else self.menu.name  # noqa: E731
        self.until(lambda: shown() == name, f"the menu {name}")

    def tap(self, *controls: str) -> None:
        for control in controls:
            self.hands.tap(control)

    def tap_until(self, control: str, menu: str | None) -> None:
        """Press a control, and wait for a menu, or for none."""
        self.tap(control)
        self.until_menu(menu)

    def choose(self, item: str, *menu: str | None) -> None:
        """Move the focus to an item and accept it; wait for the menu that follows, if named."""
        self.focus(item)
        self.tap("accept")
        for name in menu:
            self.until_menu(name)

    def go_to_experiment(self, trainee: str) -> None:
        """Read through to the experiment menu, and type an ID there."""
        self.until_menu("start")
        self.choose("train", "introduction")
        while self.menu.name != "controls":
            self.tap("accept")
        self.choose("next", "experiment")
        self.focus("trainee")
        self.hands.type(trainee)

    def focus(self, item: str) -> None:
        names = [each.name for each in self.menu.items if each.kind != "axis"]
        assert item in names, f"{self.menu.name} has {names}"
        # A menu that has opened by itself ignores input for a moment.
        self.until(lambda: self.menu.focus, "a focus")
        while self.menu.focus != item:
            before = self.menu.focus
            is_below = names.index(item) > names.index(before)
            self.tap("down" if is_below else "up")
            self.until(lambda before=before: self.menu.focus != before, "another focus")

    def item(self, name: str):
        return next(item for item in self.menu.items if item.name == name)

    def submit(self, name: str, **arguments):
        """Have a command carried out as Slicer would; return its answer."""
        future = self.loop.submit(name, check_arguments(name, arguments), "Slicer")
        self.until(future.done, f"the answer to {name}")
        return future.result()

    def open_experiment(self) -> None:
        """Go from the start menu past introduction and controls to the experiment menu."""
        self.choose("train", "introduction")
        self.choose("skip", "controls")
        self.choose("next", "experiment")

    def start(self, task: str, trainee: str = "P07", procedure: str = "") -> None:
        """Begin a task as Slicer would, and wait for its screen."""
        start = {"task": task, "trainee": trainee, "procedure": procedure}
        assert self.submit("StartTask", **start).ok
        self.until_menu(None)

    def register(self) -> str:
        """Register the touches, which are complete; return the trial's UUID."""
        self.tap_until("touch", "complete")
        self.choose("register", "waiting")
        return self.state.training.trial_id

    def place(self, label: str = "") -> np.ndarray:
        """Return where a point of the trial is, (3,) World, m; the head's center without one."""
        truth = self.loop.simulation.truth
        place = truth.fiducials_ras[label] if label else truth.target_ras
        return truth.in_world(place) / MM_PER_M

    def touch_point(self, label: str) -> None:
        self.touch(self.place(label), self.place())

    def touch(self, point: np.ndarray, center: np.ndarray) -> None:
        """Carry the tip over the head to a point of the skin (3,) m, and record a touch there."""
        self.lower_onto(point, center)
        kept = self.touched
        self.tap("touch")
        self.until(lambda: self.touched > kept, f"touch {kept + 1}")

    def lower_onto(self, point: np.ndarray, center: np.ndarray) -> None:
        """Carry the tip over the head to a point of the skin (3,) m, and lower it until contact.

        If the ring does not turn green, this is repeated, as a person would.
        """
        for _ in range(ATTEMPTS):
            self._carry_over(point, center)
            self._press_until_green((point - center) / np.linalg.norm(point - center))
            if self._stage is TouchStage.ON_SKIN:
                return

    def _carry_over(self, point: np.ndarray, center: np.ndarray) -> None:
        outward = (point - center) / np.linalg.norm(point - center)
        start = np.array(self.tip) - center
        lifted = LIFT_M + max(np.linalg.norm(point - center), np.linalg.norm(start))
        first = start / np.linalg.norm(start)
        self.steer_to(center + lifted * first, 0.02)
        for share in np.linspace(0.0, 1.0, 7)[1:]:
            between = (1.0 - share) * first + share * outward
            self.steer_to(center + lifted * between / np.linalg.norm(between), 0.02)
        self.steer_to(point + 0.01 * outward, 0.005)
        self.steer_to(point, 0.004, fine=True)
        self.steer_to(point - SINK_M * outward, 0.0, fine=True, ends_in_contact=True)
        self._let_go()

    def _press_until_green(self, outward: np.ndarray) -> None:
        """Press less or more, by short pushes, as long as the ring belongs to the next point."""
        pushes = {TouchStage.TOO_DEEP: outward, TouchStage.NEAR: -outward}
        for _ in range(SHORT_PUSHES):
            if self._stage not in pushes:
                return
            self._push_toward(0.7 * pushes[self._stage], fine=True)
            self.step()
            self._let_go()

    @property
    def _stage(self) -> TouchStage:
        return self.presenter.shown.latest.touch

    def _let_go(self) -> None:
        self.hands.push(0.0, 0.0, 0.0, False)
        self.step(2)

    @property
    def tip(self):
        return self.state.tip

    def steer_to(
        self, place: np.ndarray, near: float, fine: bool = False, ends_in_contact: bool = False
    ) -> None:
        """Push the sticks toward a place (3,) World, m, until the tip is near it, or in contact."""
        give_up = self.state.sim_time + 6.0
        full = 0.01 if fine else 0.03
        while True:
            away = np.asarray(place) - self.tip
            if np.linalg.norm(away) < near or self.state.sim_time > give_up:
                return
            if ends_in_contact and self.state.proximity is Proximity.CONTACT:
                return
            wanted = away / max(full, float(np.linalg.norm(away)))
            # Sticks hardly answer near their middle.
            wanted *= max(1.0, 0.7 / np.linalg.norm(wanted))
            self._push_toward(wanted, fine)
            self.step()

    def _push_toward(self, wanted: np.ndarray, fine: bool) -> None:
        """Push the sticks so that the tip moves as wanted (3,) World, as the view is now."""
        view = self.presenter.pictures(self.state).main
        axes = camera_axes(subtract(view.focal_point, view.position), view.view_up)
        right, forward, up = (dot(wanted, a) for a in (axes.right, axes.forward, axes.up))
        self.hands.push(right, forward, up, fine)

    def touch_anywhere(self) -> None:
        """Touch all points of a trial in which every touch counts: no two at one place."""
        for kept in range(1, 16):
            self.hands.push(*np.roll((1.0, 0.0, 0.0), kept).tolist(), False)
            self.step(15)
            self.hands.push(0.0, 0.0, 0.0, False)
            self.tap("touch")
            self.until(lambda k=kept: self.touched == k, f"touch {kept}")
        self.until(lambda: self.state.training.phase is Phase.COMPLETE, "the last touch")
        self.step(2)

    def play(self, task: str) -> None:
        """Touch all points of the running trial, as the head stands in it."""
        for number in range(1, 16):
            self.touch_point(str(number))
        assert self.state.training.phase is Phase.COMPLETE, task
        self.step(2)


class Keys:
    """A keyboard: its keys go to the presenter as a view sends them."""

    CODES: Mapping[str, str] = {
        "accept": "Enter",
        "back": "Escape",
        "up": "ArrowUp",
        "down": "ArrowDown",
        "left": "ArrowLeft",
        "right": "ArrowRight",
        "touch": "Space",
        "undo": "KeyU",
        "camera": "KeyC",
        "best_view": "KeyB",
        "pause": "KeyP",
        "menu": "KeyM",
        "view_right": "KeyE",
    }
    STICKS = (("KeyA", "KeyD"), ("KeyS", "KeyW"), ("KeyF", "KeyR"))

    def __init__(self, trainee: Trainee, view: int = 1, kind: str = "desktop"):
        self._trainee, self._view = trainee, view
        self._held: set[str] = set()
        trainee.presenter.view_joined(view, Hello(kind))

    def tap(self, control: str) -> None:
        self.key(self.CODES[control])

    def hold(self, control: str, is_down: bool) -> None:
        self._trainee.presenter.on_key(self._view, self.CODES[control], is_down, "")

    def key(self, code: str, text: str = "") -> None:
        presenter = self._trainee.presenter
        presenter.on_key(self._view, code, True, text)
        self._trainee.step()
        presenter.on_key(self._view, code, False, "")
        self._trainee.step()

    def type(self, text: str) -> None:
        for letter in text:
            self.key(f"Key{letter.upper()}" if letter.isalpha() else f"Digit{letter}", letter)

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        """Keys are pressed or not: components above half of the longest are held."""
        wanted = {"ShiftLeft"} if fine else set()
        longest = max(abs(right), abs(forward), abs(up))
        for value, (below, above) in zip((right, forward, up), self.STICKS, strict=True):
            if abs(value) > 0.5 * longest > 0.0:
                wanted.add(above if value > 0.0 else below)
        for code in self._held - wanted:
            self._trainee.presenter.on_key(self._view, code, False, "")
        for code in wanted - self._held:
            self._trainee.presenter.on_key(self._view, code, True, "")
        self._held = wanted


class Pad:
    """A gamepad that SDL reads; `plugged` is its virtual one."""

    BUTTONS: Mapping[str, str] = {
        "accept": "a",
        "back": "b",
        "up": "dpup",
        "down": "dpdown",
        "left": "dpleft",
        "right": "dpright",
        "touch": "a",
        "undo": "b",
        "camera": "y",
        "pause": "back",
        "menu": "start",
        "best_view": "x",
        "view_right": "dpright",
    }

    def __init__(self, trainee: Trainee, plugged):
        self._trainee, self.plugged = trainee, plugged

    def tap(self, control: str) -> None:
        self.plugged.press(self.BUTTONS[control])
        self._trainee.step()
        self.plugged.press(self.BUTTONS[control], False)
        self._trainee.step()

    def hold(self, control: str, is_down: bool) -> None:
        self.plugged.press(self.BUTTONS[control], is_down)

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        right, forward, up = (max(-1.0, min(1.0, value)) for value in (right, forward, up))
        self.plugged.move(leftx=right, lefty=-forward, righty=-up, righttrigger=float(fine))


class FlowLearner:
    """Does what `TutorialPlayer` asks for in the flow's own process."""

    def __init__(self, trainee):
        self.trainee = trainee
        self.hands, self.until = trainee.hands, trainee.until

    @property
    def screen(self):
        return self.trainee.presenter.screen

    def turn_view(self):
        self.hands.hold("view_right", True)
        self.trainee.step(30)
        self.hands.hold("view_right", False)
        self.trainee.step()

    def lower(self):
        self.trainee.lower_onto(*self._next())

    def touch_next(self):
        self.trainee.touch(*self._next())

    def resume(self):
        self.trainee.choose("resume", None)

    def _next(self):
        practice = self.trainee.presenter._session.tutorial.practice
        truth = practice.training.truth
        point = truth.in_world(truth.fiducials_ras[practice.training.state.next_point]) / MM_PER_M
        return point, truth.in_world(truth.target_ras) / MM_PER_M


VIEW = 1


class Mouse:
    """The input of a mouse as a view sends it: clicks on items and hints, and dragged sticks."""

    def __init__(self, trainee: Trainee, kind: str):
        self._trainee = trainee
        trainee.presenter.view_joined(VIEW, Hello(kind))

    def tap(self, control: str) -> None:
        """Click on the hint of a control."""
        self.click(f"press {control}")

    def click(self, item: str) -> None:
        """Click on a hint or an item of the menu, which must be there."""
        screen = self._trainee.presenter.screen
        shown = [hint.item for hint in screen.hints]
        shown += [] if screen.menu is None else [each.name for each in screen.menu.items]
        assert item in shown
        self._trainee.presenter.on_item(VIEW, item)
        self._trainee.step(2)

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        """Drag the sticks; slow motion is switched by a click."""
        presenter = self._trainee.presenter
        assert presenter.screen.has_sticks
        is_pushed = bool(right or forward or up)
        if is_pushed and fine != presenter._session.operator.screen_sticks.is_slow:
            presenter.on_sticks(VIEW, (0.0, 0.0, 0.0), (0.0, 0.0), False, 0.0)
            self.click("press fine")
        presenter.on_sticks(VIEW, (right, forward, up), (0.0, 0.0), False, 0.0)

    def turn_view(self, around_deg: float) -> None:
        """Drag with the right button."""
        self._trainee.presenter.on_orbit(VIEW, around_deg, 0.0, 1.0)
        self._trainee.step()


class ClickingTrainee(Trainee):
    """Goes through the menus by clicks."""

    def choose(self, item: str, *menu: str | None) -> None:
        """Click on an item, once its menu takes clicks."""
        self.until(lambda: self.menu.focus, "a focus")
        self.hands.click(item)
        for name in menu:
            self.until_menu(name)
