"""Play a trial again from its journal and compare every number with what was recorded."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, JournalReading
from rastrainer.json_records import record_from_json
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
from rastrainer_simulator.state import (
    NEUTRAL_STICKS,
    OperatorCommand,
    OperatorInput,
    StartingPoint,
    StepResult,
)

LONGEST_TRIAL_TICKS = 10_000_000
"""A journal that claims more (11 hours at 250 Hz) is not replayed."""
SHORTEST_TICK_S, LONGEST_TICK_S = 1e-4, 0.1

_NOT_SIMULATED = frozenset(
    {"header", "display", "view", "guidance", "ghost", "tutorial", "stopped", "attempt"}
    | {"registration", "scored", "acknowledged"}
)
_OF_THE_CLOCK = frozenset(
    {"n", "previous", "sha256", "monotonicS", "utc", "record", "versions", "session"}
)


@dataclass(frozen=True)
class ReplayReport:
    """The result of a replay.

    Attributes:
        compared: how many entries of each kind were compared.
        difference: the first difference in words; None if all is equal to the last bit.
        changed_versions: name → (recorded, present), where they differ.
    """

    trial_id: str
    ticks: int
    compared: Mapping[str, int]
    difference: str | None
    changed_versions: Mapping[str, tuple[str, str]]
    motion: Mapping[str, float]


def replay(
    reading: JournalReading,
    setup: SimulationSetup,
    watch: Callable[[StepResult], None] = lambda _result: None,
) -> ReplayReport:
    """Simulate a trial again from its recorded inputs.

    The computed entries are compared with the recorded ones: events, touches, 50 postures a second,
    and the hash over the posture of every tick. `watch` is called with each simulated step.
    """
    with refusing_malformed(f"{reading.path} cannot be replayed: an entry is not as it should be"):
        return _replay(reading, setup, watch)


def _replay(
    reading: JournalReading, setup: SimulationSetup, watch: Callable[[StepResult], None]
) -> ReplayReport:
    header = reading.header
    start = record_from_json(StartingPoint, header["before"])
    with refusing_malformed(f"{reading.path} cannot be replayed: its ticks are missing"):
        simulated = (entry for entry in reading.entries if entry["kind"] not in _NOT_SIMULATED)
        last = max((entry["tick"] for entry in simulated), default=start.tick)
    if not start.tick <= last <= start.tick + LONGEST_TRIAL_TICKS:
        raise InputError(f"{reading.path} has {last - start.tick} ticks: no trial is that long.")
    if not SHORTEST_TICK_S <= header["tickS"] <= LONGEST_TICK_S:
        raise InputError(
            f"{reading.path} claims ticks of {header['tickS']} s: no control loop has such."
        )
    simulation = Simulation(setup, seed_of(header))
    simulation.restart_from(start)
    player = _Player(simulation, header, watch)
    compared: dict[str, int] = defaultdict(int)
    # Each part was written by another server: a trial may be interrupted.
    starts = [n for n, entry in enumerate(reading.entries) if entry["kind"] == "continued"]
    for first, end in pairwise([0, *starts, len(reading.entries)]):
        part = [e for e in reading.entries[first:end] if e["kind"] not in _NOT_SIMULATED]
        again: Sequence[Mapping[str, Any]] = player.play_part(reading.entries[:first], part)
        is_cut = end < len(reading.entries) or reading.integrity is Integrity.CUT_SHORT
        if is_cut and all(entry["tick"] == part[-1]["tick"] for entry in again[len(part) :]):
            again = again[: len(part)]
        for entry in part:
            compared[entry["kind"]] += 1
        difference = _first_difference(part, again)
        if difference is not None:
            break
    recorded = header["versions"]
    return ReplayReport(
        trial_id=header["trialId"],
        ticks=simulation.state.tick - start.tick,
        compared=dict(compared),
        difference=difference,
        changed_versions={
            name: (recorded.get(name, "absent"), player.versions.get(name, "absent"))
            for name in sorted(recorded.keys() | player.versions.keys())
            if recorded.get(name) != player.versions.get(name)
        },
        motion=player.motion,
    )


class _Player:
    """Simulates the parts of one trial and computes their entries."""

    def __init__(
        self,
        simulation: Simulation,
        header: Mapping[str, Any],
        watch: Callable[[StepResult], None],
    ) -> None:
        self._simulation = simulation
        self._dt: float = header["tickS"]
        self._seed = seed_of(header)
        self._watch = watch
        self._entries: TrialEntries | None = None
        self.versions: Mapping[str, str] = {}
        self.motion: Mapping[str, float] = {}

    def play_part(
        self, earlier: Sequence[Mapping[str, Any]], part: Sequence[Mapping[str, Any]]
    ) -> list[dict[str, Any]]:
        """Return the computed entries of one part, without the header."""
        simulation, dt = self._simulation, self._dt
        if earlier:
            # As the server did that found the earlier parts.
            continued, interrupted = part[0], InterruptedTrial.of(earlier)
            if interrupted is None:
                raise InputError("The journal resumes a trial that was not open.")
            point = StartingPoint(
                continued["tick"], continued["simTimeS"], camera=continued["camera"]
            )
            simulation.resume_trial(interrupted, point)
            since = interrupted.point.sim_time_s
            self._entries = TrialEntries.resumed(simulation, simulation.state, earlier, since, dt)
        first = simulation.state.tick
        last = max((entry["tick"] for entry in part), default=first)
        for operator_input in _inputs(part, first, last, self._seed):
            before = simulation.state
            result = simulation.step(dt, operator_input)
            self._watch(result)
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


def _inputs(
    recorded: Sequence[Mapping[str, Any]], before: int, last: int, seed: int
) -> Iterator[OperatorInput]:
    """Yield the operator's input of every tick after `before` up to `last`."""
    sticks: dict[int, OperatorInput] = {}
    commands: dict[int, list[OperatorCommand]] = defaultdict(list)
    for entry in recorded:
        if entry["kind"] == "input":
            sticks[entry["tick"]] = OperatorInput(
                translation=tuple(entry["translation"]),
                rotation=tuple(entry["rotation"]),
                fine=entry["fine"],
                operator=entry["operator"],
            )
        elif entry["kind"] == "command":
            commands[entry["tick"]].append(recorded_command(entry, seed))
    held = NEUTRAL_STICKS
    for tick in range(before + 1, last + 1):
        held = sticks.get(tick, held)
        yield replace(held, commands=tuple(commands[tick])) if tick in commands else held


def _first_difference(
    recorded: Sequence[Mapping[str, Any]], again: Sequence[Mapping[str, Any]]
) -> str | None:
    for old, new in zip(recorded, again, strict=False):
        line, old, new = old["n"], _comparable(old), _comparable(json.loads(json.dumps(new)))
        for key in old.keys() | new.keys():
            if old.get(key) != new.get(key):
                return f"line {line}: {key} was {old.get(key)!r}, now it is {new.get(key)!r}"
    if len(recorded) != len(again):
        return f"{len(recorded)} entries were recorded, now there are {len(again)}"
    return None


def _comparable(entry: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in entry.items() if key not in _OF_THE_CLOCK}
