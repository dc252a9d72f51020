"""A recorded trial, simulated again, as the states that a view shows one after the other."""

from __future__ import annotations

import bisect
import contextlib
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.journal_reader import JournalReading
from rastrainer.journal.recording import Recording
from rastrainer.protocol import Phase
from rastrainer.trial_analysis import analyze_trial
from rastrainer.trial_record import TrialRecord
from rastrainer_simulator.record.recorded_setup import setup_of
from rastrainer_simulator.record.replay import replay
from rastrainer_simulator.setup import SimulationSetup
from rastrainer_simulator.state import Event, SimulationState, StepResult

FRAMES_HZ = 60.0
"""As many as a view shows; the simulation has more steps."""
AFTER_S = 0.25
"""How long the worst touch is seen when it has been made."""


@dataclass(frozen=True)
class Frame:
    """What is shown at a moment.

    Attributes:
        time_s: from the trial's start, with its pauses.
        state: of the simulation.
        events: what has happened since the frame before.
    """

    time_s: float
    state: SimulationState
    events: tuple[Event, ...]


@dataclass(frozen=True)
class Film:
    """A trial from its start to its end.

    Attributes:
        trainee: pseudonym.
        task: name.
        setup: head and robot.
        frames: in their order, at least one.
        worst: label of the touch with the largest error, and from when to when it was approached,
            in s; None for a trial that was not registered.
        difference: how what was simulated again differs from what was recorded; None where it is
            equal to the last bit.
    """

    trainee: str
    task: str
    setup: SimulationSetup
    frames: tuple[Frame, ...]
    worst: tuple[str, float, float] | None
    difference: str | None

    @property
    def duration_s(self) -> float:
        """How long it takes."""
        return self.frames[-1].time_s

    def at(self, time_s: float) -> int:
        """Return the number of the frame that is shown at a time."""
        times = [frame.time_s for frame in self.frames]
        return max(0, bisect.bisect_right(times, time_s) - 1)


def make_film(reading: JournalReading, scenario: Path | None = None) -> Film:
    """Simulate a trial again; that takes about as long as a tenth of the trial.

    Raises:
        InputError: the journal is none of a trial, or scenario or robot are others here.
    """
    setup = setup_of(reading.header, scenario)
    cutter = _Cutter()
    report = replay(reading, setup, cutter.add)
    if not cutter.frames:
        raise InputError(f"{reading.path} holds nothing that could be shown again.")
    return Film(
        trainee=str(reading.header["trainee"]),
        task=str(reading.header["task"]),
        setup=setup,
        frames=tuple(cutter.frames),
        worst=_worst(reading, setup),
        difference=report.difference,
    )


class _Cutter:
    """Takes the steps of a simulation and keeps what a view shows of them."""

    def __init__(self) -> None:
        self.frames: list[Frame] = []
        self._start: float | None = None
        self._events: list[Event] = []

    def add(self, result: StepResult) -> None:
        state = result.state
        if state.training.phase is Phase.IDLE and not result.events:
            return
        self._start = state.sim_time if self._start is None else self._start
        self._events += result.events
        time = state.sim_time - self._start
        if not self.frames or time - self.frames[-1].time_s >= 1.0 / FRAMES_HZ or result.events:
            self.frames.append(Frame(time, state, tuple(self._events)))
            self._events = []


def _worst(reading: JournalReading, setup: SimulationSetup) -> tuple[str, float, float] | None:
    """Return the worst touch with its interval on the film's clock, pauses included."""
    with contextlib.suppress(InputError, IndexError, KeyError):
        record = TrialRecord.from_json(reading.of_kind("registered")[0]["record"])
        trajectory = Recording.of(reading.entries).trajectory()
        worst = analyze_trial(record, setup.scenario, trajectory=trajectory).feedback.worst
        # A touch is seen in the state after the tick that it was made in.
        start = reading.header["simTime"] - reading.header["tickS"]
        ends = {p.label: p.sim_time_s - start for p in record.points}
        labels = [point.label for point in record.points]
        place = labels.index(worst.label)
        begin = ends[labels[place - 1]] if place else 0.0
        return worst.label, begin, ends[worst.label] + AFTER_S
    return None
