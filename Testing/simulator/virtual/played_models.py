"""A task played by a model that only looks, in simulated time."""

from __future__ import annotations

import functools
import math
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import t

from rastrainer.journal.entries import AcceptedTouch
from rastrainer.protocol import Phase, Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.flow.running_presenter import RunningPresenter
from rastrainer_simulator.flow.session.services import FlowServices
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.state import TOUCH_ERRORS, Answer, StepResult, TouchStage
from Testing.sdl_virtual_gamepad import VirtualGamepad
from Testing.simulator.at_once import at_once
from Testing.simulator.flow.trainee import Trainee
from Testing.simulator.virtual.drawn_pictures import DrawnPictures
from Testing.simulator.virtual.looking_trainee import LookingTrainee, NotTouchedError
from Testing.simulator.virtual.trained_hands import HANDS, TrainedMouse, TrainedPad
from Testing.without_tutorial import skip_tutorial

LIMIT_S = 300.0
"""A trial ends here: the trial run lasts five minutes, and no model has longer for a task."""
POINTS = 15
GREEN_MM = 0.5
"""Pressed in less than this, the tip is green on the point."""


@dataclass(frozen=True)
class Landing:
    """How the tip came onto a point, from its way there to the touch that counts.

    Attributes:
        deepest_mm: how deep it was pressed in.
        was_red: whether the frame was red meanwhile.
        tries: how often it came into contact.
        time_s: since the last touch.
        error_mm: distance of the touch from the point.
    """

    deepest_mm: float
    was_red: bool
    tries: int
    time_s: float
    error_mm: float

    @property
    def is_green(self) -> bool:
        """Whether the first try was green from contact to touch."""
        return self.deepest_mm <= GREEN_MM and not self.was_red and self.tries == 1


@dataclass(frozen=True)
class Outcome:
    """How a model did.

    Attributes:
        time_s: the trial's time at its last touch, or when it was ended.
        touches: how many of the 15 points were touched.
        error_mm: mean distance of the touches from their points; nan without touches.
        landings: how the tip came onto each of these points.
    """

    time_s: float
    touches: int
    error_mm: float
    landings: tuple[Landing, ...] = ()


class WatchedLandings:
    """Watches each tick how the tip comes onto the points."""

    def __init__(self) -> None:
        self.seen: list[tuple[float, bool, int, float]] = []
        self._since = 0.0
        self._begin(0.0)

    def _begin(self, now: float) -> None:
        self._has_left = self._was_red = self._is_in_contact = False
        self._deepest_mm, self._tries, self._since = 0.0, 0, now

    def take(self, result: StepResult) -> None:
        """Note a tick; the way off the last point does not count."""
        state = result.state
        self._has_left = self._has_left or state.touch is TouchStage.FAR
        if self._has_left:
            is_in_contact = state.proximity is Proximity.CONTACT
            self._tries += is_in_contact and not self._is_in_contact
            self._is_in_contact = is_in_contact
            self._deepest_mm = max(self._deepest_mm, MM_PER_M * state.depth)
            self._was_red = self._was_red or state.touch in TOUCH_ERRORS
        if any(isinstance(event.entry, AcceptedTouch) for event in result.events):
            elapsed = state.elapsed - self._since
            self.seen.append((self._deepest_mm, self._was_red, self._tries, elapsed))
            self._begin(state.elapsed)


class SteadyTrainee(Trainee):
    """A trainee at a control loop of the usual rate: what the models do is published."""

    step_s, ticks_a_step = 0.008, 2


def play(
    setup: SimulationSetup, task: str, seed: int, limit_s: float = LIMIT_S, device: str = "pad"
) -> Outcome:
    """Let a model that looks play a task, until all is touched or its time is over.

    The seed gives the head's pose and the model's eyes; the device is one of `HANDS`.
    """
    landings = WatchedLandings()
    with (
        tempfile.TemporaryDirectory() as folder,
        _at_work(setup, seed, Path(folder), device) as trainee,
    ):
        trainee.start(task)
        trainee.loop.subscribe(landings.take)
        hands = trainee.hands
        is_mouse = isinstance(hands, TrainedMouse)
        if is_mouse:
            hands.show_sticks()
        with suppress(NotTouchedError):
            LookingTrainee(trainee, hands, DrawnPictures(setup, seed), is_mouse).play(limit_s)
        state, truth = trainee.state, trainee.loop.simulation.truth
        touches = state.training.touches
        errors_mm = [
            float(np.linalg.norm(MM_PER_M * np.array(touch.position) - place))
            for touch in touches
            for place in [truth.in_world(truth.fiducials_ras[touch.label])]
        ]
        is_complete = state.training.phase is Phase.COMPLETE
        return Outcome(
            state.elapsed if is_complete else limit_s,
            len(touches),
            float(np.mean(errors_mm)) if errors_mm else float("nan"),
            tuple(
                Landing(*seen, error_mm)
                for seen, error_mm in zip(landings.seen, errors_mm, strict=True)
            ),
        )


@contextmanager
def _at_work(setup: SimulationSetup, seed: int, folder: Path, device: str) -> Iterator[Trainee]:
    """Yield a trainee with a device, at the start menu of a new simulator."""
    done: Future[Answer] = Future()
    done.set_result(Answer(0, True))
    services = FlowServices(
        config=folder / "config",
        records=folder / "records",
        use_settings=lambda _settings: done,
        list_scenarios=lambda: done,
        use_scenario=lambda _name: done,
        is_slicer_connected=lambda: True,
        quit=lambda: None,
    )
    skip_tutorial(services.config)
    gamepad = VirtualGamepad(lambda *_strengths: None)
    loop = ControlLoop(Simulation(setup, seed), folder / "records", speed=None)
    with at_once(), loop:
        running = RunningPresenter(loop, services, has_gamepad=True)
        hands = HANDS[device]
        if hands is TrainedPad:
            gamepad.plug_in()
            hands = functools.partial(TrainedPad, plugged=gamepad)
        trainee = SteadyTrainee(loop, running.presenter, hands, running.advance)
        try:
            trainee.until_menu("start")
            yield trainee
        finally:
            trainee.close()
            if gamepad.is_plugged_in:
                gamepad.unplug()
            running.close()


def mean_and_interval(values: Sequence[float]) -> str:
    """Return the mean and the half width of its 95 % interval by Student's t; "–" of none."""
    known = np.array(values)[np.isfinite(values)]
    if len(known) < 2:
        return "–" if len(known) == 0 else f"{known[0]:.2f}"
    half = t.ppf(0.975, len(known) - 1) * known.std(ddof=1) / math.sqrt(len(known))
    return f"{known.mean():.2f} ± {half:.2f}"


def play_tasks(*seeds: int) -> None:
    """Play all tasks, and print a line for each."""
    setup = load_setup()
    for task in setup.scenario.tasks:
        outcomes = [play(setup, task.name, seed) for seed in seeds]
        finished = sum(outcome.touches == POINTS for outcome in outcomes)
        each = (
            mean_and_interval([getattr(outcome, name) for outcome in outcomes])
            for name in ("touches", "time_s", "error_mm")
        )
        print(task.name, f"{finished} of {len(outcomes)} finished", *each, sep=" | ", flush=True)


def play_devices(count: int, *devices: str) -> None:
    """Touch `count` points with each device by looking, and print a line for each device."""
    setup = load_setup()
    tasks = [task.name for task in setup.scenario.tasks]
    for device in devices or tuple(HANDS):
        landings: list[Landing] = []
        given_up = 0
        for number, task in enumerate(tasks):
            if len(landings) < count:
                played = play(setup, task, 11 + number, LIMIT_S, device)
                landings.extend(played.landings)
                given_up += played.touches < POINTS
        kept = landings[:count]
        green, red = (sum(getattr(one, what) for one in kept) for what in ("is_green", "was_red"))
        each = (
            mean_and_interval([getattr(one, name) for one in kept])
            for name in ("time_s", "error_mm", "deepest_mm")
        )
        shares = f"{green} of {len(kept)} green at first, {red} red, {given_up} given up"
        print(device, shares, *each, sep=" | ", flush=True)


def main(*arguments: str) -> None:
    """Play the tasks with the seeds that are given; after `devices` a number of touches each."""
    if arguments[0] == "devices":
        play_devices(int(arguments[1]), *arguments[2:])
    else:
        play_tasks(*map(int, arguments))


if __name__ == "__main__":
    main(*sys.argv[1:])
