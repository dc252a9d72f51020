"""Drills of decisions in a folder, with real cases that are cheap to draw."""

from __future__ import annotations

import time
from contextlib import contextmanager
from unittest import mock

from rastrainer.decision.drill_record import CASES, FAULTS, Decision, Fault
from rastrainer.journal.folder import DRILL_SUFFIX
from rastrainer_simulator.decision import forms
from rastrainer_simulator.decision.drill import begin_drill
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.loop.control_loop import ControlLoop

PATIENCE_S = 120.0
SEED = 2**62 + 1234567


def cheap_form(_maker, random, seen):
    """Draw keys as `draw_form`, without making their cases."""
    keys: dict[int, Fault] = {}
    while len(keys) < CASES:
        seed = int(random.integers(2**53))
        if seed not in seen:
            keys[seed] = FAULTS[len(keys) // 2 % len(FAULTS)] if len(keys) % 2 else Fault.NONE
    return tuple(keys.items())


@contextmanager
def cheap_forms():
    with mock.patch.object(forms, "draw_form", cheap_form):
        yield


class Seat:
    """A folder of records, and the loop that delivers its drills."""

    def __init__(self, simulation, folder):
        self.folder = folder
        self.loop = ControlLoop(simulation, folder, speed=None)

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
        """Return the offered records; the journal's thread has written everything before."""
        self.loop._writer.submit(lambda: None).result()
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
    """Decide all cases, and have the drill finished."""
    while not drill.is_over:
        if drill.decided is not None:
            drill.next_case()
        shown(drill).decide(decision, 80, Fault.BENT_TOOL)
    drill.advance(0.0)
    return drill
