"""Drills of decisions in a folder, with real cases that are cheap to draw."""

from __future__ import annotations

import time
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import replace
from functools import cache
from unittest import mock

from rastrainer.decision.drill_record import CASES, FAULTS, Decision, Fault
from rastrainer.journal.folder import DRILL_SUFFIX
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.decision import forms
from rastrainer_simulator.decision.cases import CaseMaker
from rastrainer_simulator.decision.drill import begin_drill
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.loop.control_loop import ControlLoop

PATIENCE_S = 120.0
SEED = 2**62 + 1234567


@cache
def _cases(name):
    """Return a quickly made case of every fault on a scenario."""
    maker = CaseMaker(load_scenario(asset_path("scenarios", name)))
    return {fault: maker.case(1, fault) for fault in (Fault.NONE, *FAULTS)}


def cheap_form(maker, random, seen):
    """Draw cases like `draw_form`; cases of the same fault differ only by seed."""
    keys: dict[int, Fault] = {}
    while len(keys) < CASES:
        seed = int(random.integers(2**53))
        if seed not in seen:
            keys[seed] = FAULTS[len(keys) // 2 % len(FAULTS)] if len(keys) % 2 else Fault.NONE
    made = _cases(maker.scenario.name)
    return tuple(replace(made[fault], seed=seed) for seed, fault in keys.items())


@contextmanager
def cheap_forms():
    with mock.patch.object(forms, "draw_form", cheap_form):
        yield


class AtOnce(Executor):
    """Does all work before `submit` returns, like a disk that takes no time."""

    def submit(self, work, /, *given, **named):
        future = Future()
        try:
            future.set_result(work(*given, **named))
        except Exception as error:
            future.set_exception(error)
        return future


class Seat:
    """A folder of records, and the loop that delivers its drills."""

    def __init__(self, simulation, folder):
        self.folder = folder
        self.loop = ControlLoop(simulation, folder, speed=None)
        self.loop._writer = AtOnce()

    @property
    def history(self):
        return TraineeHistory(self.folder)

    @property
    def path(self):
        (path,) = self.folder.glob(f"*{DRILL_SUFFIX}")
        return path

    def begin(self, trainee="P01", seed=SEED, seen=()):
        return shown(begin_drill(self.folder, trainee, "desktop", self.loop, seed, seen))

    def delivered(self):
        return self.loop.archive.unacknowledged()


def shown(drill):
    """Wait until the present case is shown; no time passes in the drill."""
    give_up = time.monotonic() + PATIENCE_S
    while not drill.is_ready:
        drill.advance(0.0)
        time.sleep(0.001)
        assert time.monotonic() < give_up
    return drill


def decide_all(drill, decision=Decision.STOP):
    """Decide all cases, and finish the drill."""
    while not drill.is_over:
        if drill.decided is not None:
            drill.next_case()
        shown(drill).decide(decision, 80, Fault.BENT_TOOL)
    drill.advance(0.0)
    return drill
