"""A recorded trial, simulated again, as the states that a view shows one after the other."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass

from rastrainer.errors import InputError
from rastrainer.journal.journal_reader import JournalReading
from rastrainer.journal.recording import Recording
from rastrainer.protocol import Phase
from rastrainer.trial_analysis import analyze_trial
from rastrainer.trial_record import TrialRecord
from rastrainer_simulator.record.replay import replay, tick_span
from rastrainer_simulator.replaying.reel import Frame, Reel
from rastrainer_simulator.setup import SimulationSetup
from rastrainer_simulator.state import Event, StepResult

FRAMES_HZ = 60.0
"""As many as a view shows; the simulation has more steps."""
AFTER_S = 0.25
"""How long the worst touch is seen when it has been made."""
TELL_EVERY = 60
"""After so many frames the progress is told."""


@dataclass(frozen=True)
class Film:
    """A trial from its start to its end.

    Attributes:
        trainee: pseudonym.
        task: name.
        frames: in their order, at least one; none while the trial was paused.
        worst: label of the touch with the largest error, and from when to when it was approached,
            in s; None for a trial that was not registered.
        difference: how what was simulated again differs from what was recorded; None where it is
            equal to the last bit.
    """

    trainee: str
    task: str
    frames: Reel
    worst: tuple[str, float, float] | None
    difference: str | None

    @property
    def duration_s(self) -> float:
        """How long it takes."""
        return self.frames[-1].time_s


def make_film(
    reading: JournalReading,
    setup: SimulationSetup,
    progress: Callable[[float], None] = lambda _share: None,
) -> Film:
    """Simulate a trial again; that takes about as long as a tenth of the trial.

    Args:
        reading: the trial's journal, which is only read.
        setup: what the journal's header describes.
        progress: told the share of the work done, 0 to 1, some times.

    Raises:
        InputError: the journal is none of a trial.
    """
    cutter = _Cutter(tick_span(reading), progress)
    report = replay(reading, setup, cutter.take)
    if not cutter.reel:
        raise InputError(f"{reading.path} holds nothing that could be shown again.")
    return Film(
        trainee=str(reading.header["trainee"]),
        task=str(reading.header["task"]),
        frames=cutter.reel,
        worst=_worst(reading, setup),
        difference=report.difference,
    )


class _Cutter:
    """Takes the steps of a simulation and keeps what a view shows of them."""

    def __init__(self, ticks: tuple[int, int], progress: Callable[[float], None]) -> None:
        self.reel = Reel()
        self._first, self._end = ticks
        self._progress = progress
        self._start: float | None = None
        self._due_s = 0.0
        self._events: list[Event] = []

    def take(self, result: StepResult) -> None:
        state = result.state
        if state.training.phase is Phase.IDLE and not result.events:
            return
        self._start = state.sim_time if self._start is None else self._start
        self._events += result.events
        time = state.sim_time - self._start
        # Nothing moves in a pause, however long it is.
        is_due = time >= self._due_s and state.training.phase is not Phase.PAUSED
        if result.events or is_due:
            self.reel.add(Frame(time, state, tuple(self._events)))
            self._due_s = time + 1.0 / FRAMES_HZ
            self._events = []
            self._tell(state.tick)

    def _tell(self, tick: int) -> None:
        if len(self.reel) % TELL_EVERY == 0:
            self._progress((tick - self._first) / max(1, self._end - self._first))


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
