"""A task played by a model that only looks, or by one that only reads, in simulated time."""

from __future__ import annotations

import json
import math
import sys
import tempfile
from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import t

from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.flow.running_presenter import RunningPresenter
from rastrainer_simulator.flow.session.preferences import PREFERENCES_FILE
from rastrainer_simulator.flow.session.services import FlowServices
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.state import Answer
from Testing.sdl_virtual_gamepad import VirtualGamepad
from Testing.simulator.at_once import at_once
from Testing.simulator.flow.trainee import Trainee
from Testing.simulator.virtual.drawn_pictures import DrawnPictures
from Testing.simulator.virtual.looking_trainee import LookingTrainee
from Testing.simulator.virtual.reading_trainee import ReadingTrainee
from Testing.simulator.virtual.trained_pad import TrainedPad
from Testing.without_tutorial import skip_tutorial

LIMIT_S = 300.0
"""A trial ends here: the trial run lasts five minutes, and no model has longer for a task."""
POINTS = 15
MODELS = ("looks", "reads")


@dataclass(frozen=True)
class Outcome:
    """How a model did.

    Attributes:
        time_s: the trial's time at its last touch, or when it was ended.
        touches: how many of the 15 points were touched.
        error_mm: mean distance of the touches from their points; nan without touches.
    """

    time_s: float
    touches: int
    error_mm: float

    def is_worse_than(self, other: Outcome) -> bool:
        """Return whether fewer points were touched, or as many later and less accurately."""
        is_late = self.time_s > other.time_s and self.error_mm > other.error_mm
        return is_late if self.touches == other.touches else self.touches < other.touches


class SteadyTrainee(Trainee):
    """A trainee at a control loop of the usual rate: what the models do is published."""

    step_s, ticks_a_step = 0.008, 2


def play(
    setup: SimulationSetup, model: str, task: str, seed: int, limit_s: float = LIMIT_S
) -> Outcome:
    """Let a model (one of `MODELS`) play a task, until all is touched or its time is over.

    The seed is that of the head's pose, and of the model's eyes or choices.
    """
    with (
        tempfile.TemporaryDirectory() as folder,
        _at_work(setup, seed, Path(folder), model) as trainee,
    ):
        trainee.start(task)
        if model == "looks":
            LookingTrainee(trainee, trainee.hands, DrawnPictures(setup, seed)).play(limit_s)
        else:
            ReadingTrainee(trainee, trainee.hands).play(limit_s)
        state, truth = trainee.state, trainee.loop.truth
        touches = state.training.touches
        errors = [
            MM_PER_M * np.array(touch.position) - truth.in_world(truth.fiducials[touch.label])
            for touch in touches
        ]
        error_mm = float(np.mean(np.linalg.norm(errors, axis=1))) if errors else float("nan")
        is_complete = state.training.phase is Phase.COMPLETE
        return Outcome(state.elapsed if is_complete else limit_s, len(touches), error_mm)


@contextmanager
def _at_work(setup: SimulationSetup, seed: int, folder: Path, model: str) -> Iterator[Trainee]:
    """Yield a trainee with a gamepad, at the start menu of their own simulator."""
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
    if model == "reads":
        # The view stays, so that directions keep their meaning to those who do not see it turn.
        path = services.config / PREFERENCES_FILE
        preferences = json.loads(path.read_text(encoding="utf-8"))
        path.write_text(json.dumps({**preferences, "view": "never"}), encoding="utf-8")
    gamepad = VirtualGamepad(lambda *_strengths: None)
    loop = ControlLoop(Simulation(setup, seed), folder / "records", speed=None)
    with at_once(), loop:
        running = RunningPresenter(loop, services, has_gamepad=True)
        gamepad.plug_in()
        trainee = SteadyTrainee(
            loop, running.presenter, lambda it: TrainedPad(it, gamepad), running.advance
        )
        try:
            trainee.until_menu("start")
            yield trainee
        finally:
            trainee.close()
            gamepad.unplug()
            running.close()


def mean_and_interval(values: Sequence[float]) -> str:
    """Return the mean and the half width of its 95 % interval by Student's t; "–" of none."""
    known = np.array(values)[np.isfinite(values)]
    if len(known) < 2:
        return "–" if len(known) == 0 else f"{known[0]:.2f}"
    half = t.ppf(0.975, len(known) - 1) * known.std(ddof=1) / math.sqrt(len(known))
    return f"{known.mean():.2f} ± {half:.2f}"


def main(*arguments: str) -> None:
    """Play all tasks with the seeds that are given, and print a line for each trial and task."""
    setup = load_setup()
    for task in setup.scenario.tasks:
        for model in MODELS:
            outcomes = []
            for seed in map(int, arguments):
                outcomes.append(play(setup, model, task.name, seed))
                print(seed, task.name, model, outcomes[-1], flush=True)
            finished = sum(outcome.touches == POINTS for outcome in outcomes)
            each = (
                mean_and_interval([getattr(outcome, name) for outcome in outcomes])
                for name in ("touches", "time_s", "error_mm")
            )
            print(task.name, model, f"{finished} of {len(outcomes)} finished", *each, sep=" | ")


if __name__ == "__main__":
    main(*sys.argv[1:])
