"""The trial that was open when a simulator ended, and where to resume it by its journal.

The state machine of the trial is led through the recorded commands again; the arm takes the last
recorded posture, drill and instrument the last depth. Nothing is simulated, so that it takes no
time and no version of the arm's mathematics can change it.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rastrainer.commands import COMMANDS, CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.journal.folder import newest_journal
from rastrainer.journal.journal_file import SEED_SUFFIX, Integrity, JournalReading, read_journal
from rastrainer.protocol import Phase, Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.procedure_motion import FEED_PHASES
from rastrainer_simulator.state import OperatorCommand, StartingPoint
from rastrainer_simulator.training.feed import NO_FEED, Feed, HeadAhead
from rastrainer_simulator.training.rules import INTERRUPTED, RECORDING_FAILED, TRACED, TouchMoment
from rastrainer_simulator.training.trial_start import DRAWN_SEED
from rastrainer_simulator.vectors import ZERO, vector


@contextlib.contextmanager
def refusing_malformed(sentence: str) -> Iterator[None]:
    """Raise InputError with a sentence if a journal's entries are malformed: forged, or foreign."""
    try:
        yield
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(f"{sentence} ({error!r}).") from None


MALFORMED = "A journal entry is malformed"


def seed_of(header: Mapping[str, Any]) -> int:
    """Return the seed of the head's pose; raise `InputError` if the journal does not reveal it."""
    if "seed" not in header:
        raise InputError(
            "The journal of a trial that was not ended does not tell where the head was: keep the "
            f"file of the same name with the ending {SEED_SUFFIX} beside it."
        )
    seed: int = header["seed"]
    return seed


class RecordedFeed:
    """Follows the feed through a journal's entries."""

    def __init__(self) -> None:
        self.feed = NO_FEED
        self._ahead = HeadAhead()
        self._stage = Phase.RUNNING

    def before(self, effect: Mapping[str, Any]) -> Feed:
        """Return the feed with which a command had an effect."""
        ahead = self._ahead
        if "ahead" in effect:
            found = (effect["ahead"][name] for name in ("skinMm", "outerMm", "innerMm"))
            ahead = HeadAhead(*(None if each is None else meters(each) for each in found))
        drilled = meters(effect.get("drilledMm", 0.0))
        return Feed(meters(effect.get("feedMm", 0.0)), drilled, ahead)

    def take(self, entry: Mapping[str, Any]) -> None:
        if entry["kind"] == "sample" and "feedMm" in entry:
            depth = meters(entry["feedMm"])
            deepest = depth if self._stage is Phase.DRILLING else 0.0
            drilled = max(self.feed.drilled, deepest)
            self.feed = replace(self.feed, depth=depth, drilled=drilled)
        elif entry["kind"] == "phase" and "procedure" in entry:
            stage, feed = Phase(entry["procedure"]["stage"]), self.before(entry)
            if self._stage is Phase.DRILLING and stage is Phase.INSERTING:
                feed = replace(feed, depth=0.0)  # The drill was exchanged for the electrode.
            self._stage, self._ahead = stage, feed.ahead
            self.feed = feed if stage in FEED_PHASES else NO_FEED


def meters(value_mm: float) -> float:
    """Return the number whose product with 1000 is the given one to the last bit."""
    near = value_mm / MM_PER_M
    candidates = (near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf))
    return next((each for each in candidates if MM_PER_M * each == value_mm), near)


_OVER = frozenset({"registered", "aborted", "attempt"})
_EFFECTS: Mapping[str, frozenset[str]] = {
    **{each: each.entries for each in COMMANDS.values() if each.entries},
    RECORDING_FAILED: frozenset({"phase"}),
}
"""The kinds of entries that show that a command was carried out."""


@dataclass(frozen=True)
class InterruptedTrial:
    """The point at which a trial resumes, by its last records.

    `steps` are the commands that were carried out, each with its moment; the last one pauses.
    `q` are joint angles in rad, None before the first sample.
    """

    revision_before: int
    steps: tuple[tuple[OperatorCommand, TouchMoment], ...]
    point: StartingPoint
    q: tuple[float, ...] | None
    proximity: Proximity
    is_within_reach: bool
    obstacle: str
    feed: Feed = NO_FEED

    @classmethod
    @refusing_malformed(MALFORMED)
    def of(cls, entries: Sequence[Mapping[str, Any]]) -> InterruptedTrial | None:
        """Read the entries of a journal; None if no trial is open."""
        if any(entry["kind"] in _OVER for entry in entries):
            return None
        header = entries[0]
        seed_of(header)
        recorded = RecordedFeed()
        steps = list(_steps(entries, header["tickS"], recorded))
        if not steps:
            return None
        last = max(entries, key=lambda entry: entry["tick"])
        steps.append((OperatorCommand(INTERRUPTED), TouchMoment(last["simTimeS"], ZERO, 0.0)))
        latest = {entry["kind"]: entry for entry in entries}
        cameras = [each["camera"] for each in entries if each["kind"] in ("camera", "continued")]
        camera = cameras[-1] if cameras else header["before"]["camera"]
        reach = latest.get("reach", {"isWithinReach": True, "obstacle": ""})
        return cls(
            revision_before=header["before"]["revision"],
            steps=tuple(steps),
            point=StartingPoint(last["tick"], last["simTimeS"], camera=camera),
            q=tuple(map(float, latest["sample"]["q"])) if "sample" in latest else None,
            proximity=Proximity(latest["proximity"]["to"] if "proximity" in latest else "free"),
            is_within_reach=reach["isWithinReach"],
            obstacle=reach["obstacle"],
            feed=recorded.feed,
        )


def find_interrupted(folder: Path) -> tuple[JournalReading, InterruptedTrial] | None:
    """Return the journal of the newest trial in a folder, and where to resume it.

    None if that trial was registered or aborted; older trials are not looked at.
    """
    path = newest_journal(folder)
    if path is None or path.stat().st_size == 0:
        return None
    reading = read_journal(path)
    if reading.integrity is Integrity.ALTERED:
        raise InputError(f"{reading.path} is {reading.sentence}; the trial cannot be continued.")
    trial = InterruptedTrial.of(reading.entries) if reading.entries else None
    return None if trial is None else (reading, trial)


def recorded_command(entry: Mapping[str, Any], seed: int) -> OperatorCommand:
    """Return a recorded command; its arguments are checked, as the file may be forged."""
    name = entry["name"]
    arguments = {key: value for key, value in entry["arguments"].items() if value is not None}
    if name == RECORDING_FAILED:
        return OperatorCommand(name, arguments)
    own = {}
    if name == CommandName.START_TASK:
        own = {"trialId": arguments.pop("trialId"), DRAWN_SEED: seed}
    return OperatorCommand(name, check_arguments(name, arguments) | own, 0, entry["sender"])


def _steps(
    entries: Sequence[Mapping[str, Any]], tick_s: float, recorded: RecordedFeed
) -> Iterator[tuple[OperatorCommand, TouchMoment]]:
    """Yield what changed the trial.

    A command whose effect is not in the journal was refused, or the server ended before the effect
    was written: no client has seen it.
    """
    for _tick, group in itertools.groupby(entries, key=lambda entry: entry["tick"]):
        together = list(group)
        for number, entry in enumerate(together):
            recorded.take(entry)
            if entry["kind"] == "continued":
                yield OperatorCommand(INTERRUPTED), TouchMoment(entry["sinceS"], ZERO, 0.0)
            if entry["kind"] == "trace":
                # It was left at the end of its tick, unlike the effect of a command.
                place = vector(map(meters, entry["positionMm"]))
                yield OperatorCommand(TRACED), TouchMoment(entry["simTimeS"], place, 0.0)
            if entry["kind"] != "command" or entry["name"] not in _EFFECTS:
                continue
            kinds = _EFFECTS[entry["name"]]
            effect = next((each for each in together[number:] if each["kind"] in kinds), None)
            if effect is not None:
                # Commands are carried out at the state reached, one tick before their line.
                moment = TouchMoment(
                    sim_time=entry["simTimeS"] - tick_s,
                    tip=vector(map(meters, effect.get("positionMm", ZERO))),
                    tip_clearance=float(effect.get("clearanceMm", 0.0)) / MM_PER_M,
                    direction=vector(effect.get("direction", ZERO)),
                    feed=recorded.before(effect),
                )
                yield recorded_command(entry, seed_of(entries[0])), moment
