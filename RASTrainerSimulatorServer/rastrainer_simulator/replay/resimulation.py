"""Simulate a trial again from its journal and compare every number with the recorded number."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from rastrainer.errors import InputError
from rastrainer.journal.entries import (
    Acknowledged,
    Attempt,
    CommandDone,
    Continued,
    FinalRegistration,
    Input,
    JournalHeader,
    Line,
    Report,
    Scored,
    StartingPoint,
    Stopped,
)
from rastrainer.journal.journal_file import Integrity, JournalReading
from rastrainer.protocol import FINISHED_PHASES
from rastrainer_simulator.core.interrupted_trial import (
    InterruptedTrial,
    recorded_command,
    refusing_malformed,
    seed_of,
)
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.trial_entries import TrialEntries
from rastrainer_simulator.state import NEUTRAL_STICKS, OperatorCommand, OperatorInput

LONGEST_TRIAL_TICKS = 10_000_000
"""A journal that claims more (11 hours at 250 Hz) is not replayed."""

_NOT_SIMULATED = (JournalHeader, Report, Stopped, Attempt, FinalRegistration, Scored, Acknowledged)
_OF_THE_CLOCK = frozenset(
    {"n", "previous", "sha256", "monotonicS", "utc", "record", "versions", "session"}
)


@dataclass(frozen=True)
class ReplayReport:
    """The result of a replay.

    `compared` counts the entries of each kind; `difference` is the first one in words, None if all
    is equal to the last bit; `changed_versions` are recorded and present, by name.
    """

    trial_id: str
    ticks: int
    compared: Mapping[str, int]
    difference: str | None
    changed_versions: Mapping[str, tuple[str, str]]
    motion: Mapping[str, float]


@refusing_malformed("The journal cannot be replayed: an entry is not as it should be")
def replay(reading: JournalReading, setup: SimulationSetup) -> ReplayReport:
    """Simulate a trial again from its recorded inputs.

    The computed entries are compared with the recorded entries: events, touches, 50 postures a
    second, and the hash over the posture of every tick.
    """
    header = reading.header
    start = header.before
    lines = tuple(zip(reading.lines(), reading.entries, strict=True))
    simulated = [line.at.tick for line, _ in lines if not isinstance(line.entry, _NOT_SIMULATED)]
    last = max(simulated, default=start.tick)
    if not start.tick <= last <= start.tick + LONGEST_TRIAL_TICKS:
        raise InputError(f"{reading.path} has {last - start.tick} ticks: no trial is that long.")
    simulation = Simulation(setup, seed_of(header))
    simulation.restart_from(start)
    player = _Player(simulation, header)
    compared: dict[str, int] = defaultdict(int)
    # Each part was written by another server: a trial may be interrupted.
    starts = [n for n, (line, _) in enumerate(lines) if isinstance(line.entry, Continued)]
    for first, end in pairwise([0, *starts, len(lines)]):
        part = [each for each in lines[first:end] if not isinstance(each[0].entry, _NOT_SIMULATED)]
        earlier = [line for line, _ in lines[:first]]
        again: Sequence[Line] = player.play_part(earlier, [line for line, _ in part])
        is_cut = end < len(lines) or reading.integrity is Integrity.CUT_SHORT
        if is_cut and all(line.at.tick == part[-1][0].at.tick for line in again[len(part) :]):
            again = again[: len(part)]
        for line, _ in part:
            compared[line.entry.kind] += 1
        difference = _first_difference([values for _, values in part], again)
        if difference is not None:
            break
    return ReplayReport(
        trial_id=header.trial_id,
        ticks=simulation.state.tick - start.tick,
        compared=dict(compared),
        difference=difference,
        changed_versions={
            name: (header.versions.get(name, "absent"), player.versions.get(name, "absent"))
            for name in sorted(header.versions.keys() | player.versions.keys())
            if header.versions.get(name) != player.versions.get(name)
        },
        motion=player.motion,
    )


class _Player:
    """Simulates the parts of one trial and computes their entries."""

    def __init__(self, simulation: Simulation, header: JournalHeader) -> None:
        self._simulation = simulation
        self._dt = header.tick_s
        self._seed = seed_of(header)
        self._entries: TrialEntries | None = None
        self.versions: Mapping[str, str] = {}
        self.motion: Mapping[str, float] = {}

    def play_part(self, earlier: Sequence[Line], part: Sequence[Line]) -> list[Line]:
        """Return the computed entries of one part, without the header."""
        simulation, dt = self._simulation, self._dt
        if earlier:
            # As the server did that found the earlier parts.
            (at, continued), interrupted = part[0], InterruptedTrial.of(earlier)
            if interrupted is None:
                raise InputError("The journal resumes a trial that was not open.")
            assert isinstance(continued, Continued)
            point = StartingPoint(at.tick, at.sim_time_s, 0, continued.camera)
            simulation.resume_trial(interrupted, point)
            since = interrupted.point.sim_time_s
            self._entries = TrialEntries.resumed(simulation, simulation.state, earlier, since, dt)
        first = simulation.state.tick
        last = max((line.at.tick for line in part), default=first)
        for operator_input in _inputs(part, first, last, self._seed):
            before = simulation.state
            result = simulation.step(dt, operator_input)
            if self._entries is None:
                self._entries = TrialEntries.started(simulation, before, result, dt)
            if self._entries.add(simulation, operator_input, result) is not None:
                self.motion = self._entries.motion()
        if self._entries is None:
            return []
        self.versions = self._entries.records.versions
        # A registered trial ends with its record: motion until the score came is not part of it.
        if self._simulation.state.training.phase not in FINISHED_PHASES:
            self.motion = self._entries.motion()
        return self._entries.taken()[0 if earlier else 1 :]


def _inputs(recorded: Sequence[Line], before: int, last: int, seed: int) -> Iterator[OperatorInput]:
    sticks: dict[int, OperatorInput] = {}
    commands: dict[int, list[OperatorCommand]] = defaultdict(list)
    for at, entry in recorded:
        if isinstance(entry, Input):
            sticks[at.tick] = OperatorInput(
                entry.translation, entry.rotation, entry.fine, operator=entry.operator
            )
        elif isinstance(entry, CommandDone):
            commands[at.tick].append(recorded_command(entry, seed))
    held = NEUTRAL_STICKS
    for tick in range(before + 1, last + 1):
        held = sticks.get(tick, held)
        yield replace(held, commands=tuple(commands[tick])) if tick in commands else held


def _first_difference(recorded: Sequence[Mapping[str, Any]], again: Sequence[Line]) -> str | None:
    for old, line in zip(recorded, again, strict=False):
        new = json.loads(json.dumps(line.to_json()))
        for key in (old.keys() | new.keys()) - _OF_THE_CLOCK:
            if old.get(key) != new.get(key):
                n = old["n"]
                return f"line {n}: {key} was {old.get(key)!r}, now it is {new.get(key)!r}"
    if len(recorded) != len(again):
        return f"{len(recorded)} entries were recorded, now there are {len(again)}"
    return None
