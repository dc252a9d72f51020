"""Play a trial again from its journal and compare every number with what was recorded."""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.journal.journal_reader import Integrity, JournalReading
from rastrainer.protocol import CommandName, check_arguments
from rastrainer_simulator.operator_input import HANDS_OFF, Command, OperatorInput
from rastrainer_simulator.record.replay_metrics import ReplayMetrics
from rastrainer_simulator.record.trial_entries import TrialEntries
from rastrainer_simulator.settings import SimulationSettings, settings_from_json
from rastrainer_simulator.setup import SimulationSetup, load_setup
from rastrainer_simulator.simulation import Simulation
from rastrainer_simulator.state import StartingPoint
from rastrainer_simulator.training.phase_rules import RECORDING_FAILED

LONGEST_TRIAL_TICKS = 10_000_000
"""A journal that claims more (11 hours at 250 Hz) is not replayed."""
SHORTEST_TICK_S, LONGEST_TICK_S = 1e-4, 0.1

_NOT_SIMULATED = frozenset({"header", "display", "stopped", "scored", "acknowledged"})
_OF_THE_CLOCK = frozenset({"n", "previous", "sha256", "monotonic", "utc", "record"})


@dataclass(frozen=True)
class ReplayReport:
    """What a replay has found.

    Attributes:
        trial_id: of the trial.
        ticks: simulated again.
        compared: how many entries of each kind were compared.
        difference: the first difference in words; None where all is equal to the last bit.
        changed_versions: name → (recorded, present), where they differ.
        metrics: of the replayed trajectory.
    """

    trial_id: str
    ticks: int
    compared: Mapping[str, int]
    difference: str | None
    changed_versions: Mapping[str, tuple[str, str]]
    metrics: ReplayMetrics

    @property
    def is_identical(self) -> bool:
        """Whether trajectory and touches are equal to the last bit."""
        return self.difference is None


def replay(reading: JournalReading, setup: SimulationSetup) -> ReplayReport:
    """Simulate a trial again from its recorded inputs.

    The replay forms the journal's entries anew and compares them with the recorded ones: events,
    touches, 50 postures a second, and the hash over the posture of every single tick.

    Raises:
        InputError: the journal's entries are not those of a trial.
    """
    try:
        return _replay(reading, setup)
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(
            f"{reading.path} cannot be replayed: an entry is not as it should be ({error!r})."
        ) from None


def setup_of(header: Mapping[str, Any], scenario_folder: Path | None = None) -> SimulationSetup:
    """Return the setup that a journal's header describes.

    Raises:
        InputError: the scenario here is another, or the header is not usable.
    """
    try:
        settings = settings_from_json(SimulationSettings, header["settings"])
        name, sha256 = header["scenario"]["name"], header["scenario"]["sha256"]
    except (KeyError, TypeError, AttributeError):
        raise InputError("The journal's header lacks the scenario or the settings.") from None
    setup = load_setup(scenario_folder, settings)
    if setup.scenario_sha256 != sha256:
        raise InputError(
            f"The trial was recorded with a scenario {name!r} whose files differ from those of "
            f"{setup.scenario.name!r} here: give its folder with --scenario."
        )
    return setup


def _replay(reading: JournalReading, setup: SimulationSetup) -> ReplayReport:
    header = reading.header
    recorded = [entry for entry in reading.entries if entry["kind"] not in _NOT_SIMULATED]
    start = StartingPoint(**header["before"])
    last = max((entry["tick"] for entry in recorded), default=start.tick)
    if not start.tick <= last <= start.tick + LONGEST_TRIAL_TICKS:
        raise InputError(f"{reading.path} claims {last - start.tick} ticks: no trial is so long.")
    if not SHORTEST_TICK_S <= header["tickS"] <= LONGEST_TICK_S:
        raise InputError(f"{reading.path} claims ticks of {header['tickS']} s: no loop has them.")
    simulation = Simulation(setup, header["seed"])
    simulation.continue_from(start)
    dt = header["tickS"]
    entries: TrialEntries | None = None
    metrics = ReplayMetrics()
    for operator_input in _inputs(recorded, start.tick, last):
        before = simulation.state
        result = simulation.step(dt, operator_input)
        if entries is None:
            entries = TrialEntries(simulation, before, result, dt)
        entries.add(simulation, operator_input, result)
        metrics = metrics.after(dt, before, result)
    again = entries.taken()[1:] if entries else []
    if reading.integrity is Integrity.CUT_SHORT:
        again = _without_what_was_cut(again, recorded)
    compared: dict[str, int] = defaultdict(int)
    for entry in recorded:
        compared[entry["kind"]] += 1
    return ReplayReport(
        trial_id=header["trialId"],
        ticks=last - start.tick,
        compared=dict(compared),
        difference=_first_difference(recorded, again),
        changed_versions=_changed(header["versions"], entries.versions if entries else {}),
        metrics=metrics,
    )


def _inputs(
    recorded: Sequence[Mapping[str, Any]], before: int, last: int
) -> Iterator[OperatorInput]:
    """Yield the operator's input of every tick after `before` up to `last`."""
    sticks: dict[int, OperatorInput] = {}
    commands: dict[int, list[Command]] = defaultdict(list)
    for entry in recorded:
        if entry["kind"] == "input":
            sticks[entry["tick"]] = OperatorInput(
                translation=tuple(entry["translation"]),
                rotation=tuple(entry["rotation"]),
                fine=entry["fine"],
                operator=entry["operator"],
            )
        elif entry["kind"] == "command":
            commands[entry["tick"]].append(_command(entry))
    held = HANDS_OFF
    for tick in range(before + 1, last + 1):
        held = sticks.get(tick, held)
        yield replace(held, commands=tuple(commands[tick])) if tick in commands else held


def _command(entry: Mapping[str, Any]) -> Command:
    """Return a recorded command; its arguments are checked anew, as the file may be forged."""
    name = entry["name"]
    arguments = {key: value for key, value in entry["arguments"].items() if value is not None}
    if name == RECORDING_FAILED:
        return Command(name, arguments)
    own = {"trialId": arguments.pop("trialId")} if name == CommandName.START_TASK else {}
    return Command(name, check_arguments(name, arguments) | own, 0, entry["sender"])


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


def _without_what_was_cut(
    again: Sequence[Mapping[str, Any]], recorded: Sequence[Mapping[str, Any]]
) -> Sequence[Mapping[str, Any]]:
    """Leave out what the last tick says beyond the cut, which may lie between its lines."""
    beyond = again[len(recorded) :]
    is_last_tick = all(entry["tick"] == recorded[-1]["tick"] for entry in beyond)
    return again[: len(recorded)] if is_last_tick else again


def _comparable(entry: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in entry.items() if key not in _OF_THE_CLOCK}


def _changed(recorded: Mapping[str, str], present: Mapping[str, str]) -> dict[str, tuple[str, str]]:
    return {
        name: (recorded.get(name, "absent"), present.get(name, "absent"))
        for name in sorted(recorded.keys() | present.keys())
        if recorded.get(name) != present.get(name)
    }
