"""The trial that was open when a simulator ended, and where to resume it by its journal.

The state machine of the trial is led through the recorded commands again; the arm takes the last
recorded posture, drill and instrument the last depth. Nothing is simulated, so that it takes no
time and no version of the arm's mathematics can change it.
"""

from __future__ import annotations

import contextlib
import itertools
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from rastrainer.commands import COMMANDS, CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.journal.entries import (
    Aborted,
    Attempt,
    CameraChange,
    CommandDone,
    Continued,
    Entry,
    JournalHeader,
    Line,
    PhaseChange,
    ProximityChange,
    Reach,
    Registered,
    Sample,
    Stamp,
    StartingPoint,
    TracePoint,
)
from rastrainer.journal.folder import newest_journal
from rastrainer.journal.journal_file import SEED_SUFFIX, Integrity, JournalReading, read_journal
from rastrainer.protocol import Phase, Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.procedure_motion import FEED_PHASES
from rastrainer_simulator.state import OperatorCommand
from rastrainer_simulator.training.feed import NO_FEED, Feed, HeadAhead
from rastrainer_simulator.training.rules import INTERRUPTED, RECORDING_FAILED, TRACED, TouchMoment
from rastrainer_simulator.training.trial_start import DRAWN_SEED
from rastrainer_simulator.vectors import ZERO, vector


@contextlib.contextmanager
def refusing_malformed(sentence: str = "A journal entry is malformed") -> Iterator[None]:
    """Raise InputError with a sentence if a journal's entries are malformed: forged, or foreign."""
    try:
        yield
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(f"{sentence} ({error!r}).") from None


def seed_of(header: JournalHeader) -> int:
    """Return the seed of the head's pose; raise `InputError` if the journal does not reveal it."""
    if header.seed is None:
        raise InputError(
            "The journal of a trial that was not ended does not tell where the head was: keep the "
            f"file of the same name with the ending {SEED_SUFFIX} beside it."
        )
    return header.seed


class RecordedFeed:
    """Follows the feed through a journal's entries."""

    def __init__(self) -> None:
        self.feed = NO_FEED
        self._ahead = HeadAhead()
        self._stage = Phase.RUNNING

    def before(self, effect: Entry) -> Feed:
        if not isinstance(effect, PhaseChange):
            return Feed(ahead=self._ahead)
        found = effect.ahead
        ahead = self._ahead
        if found is not None:
            distances = (found.skin_mm, found.outer_mm, found.inner_mm)
            ahead = HeadAhead(*(None if mm is None else meters(mm) for mm in distances))
        return Feed(meters(effect.feed_mm or 0.0), meters(effect.drilled_mm or 0.0), ahead)

    def take(self, entry: Entry) -> None:
        if isinstance(entry, Sample) and entry.feed_mm is not None:
            depth = meters(entry.feed_mm)
            deepest = depth if self._stage is Phase.DRILLING else 0.0
            drilled = max(self.feed.drilled, deepest)
            self.feed = replace(self.feed, depth=depth, drilled=drilled)
        elif isinstance(entry, PhaseChange) and entry.procedure is not None:
            stage = entry.procedure.stage
            is_exchanged = self._stage is Phase.DRILLING and stage is Phase.INSERTING
            feed = self.before(entry)
            self._stage, self._ahead = stage, feed.ahead
            if stage not in FEED_PHASES:
                self.feed = NO_FEED
            else:
                self.feed = replace(feed, depth=0.0) if is_exchanged else feed


def meters(value_mm: float) -> float:
    """Return the number whose product with 1000 is the given one to the last bit."""
    near = value_mm / MM_PER_M
    candidates = (near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf))
    return next((each for each in candidates if MM_PER_M * each == value_mm), near)


_EFFECTS: Mapping[str, frozenset[str]] = {
    **{each: each.entries for each in COMMANDS.values() if each.entries},
    CommandName.ABORT: frozenset({"phase"}),
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
    reach: Reach
    feed: Feed = NO_FEED

    @classmethod
    @refusing_malformed()
    def of(cls, lines: Sequence[Line]) -> InterruptedTrial | None:
        """Read the lines of a journal; None if no trial is open."""
        if any(isinstance(line.entry, Registered | Aborted | Attempt) for line in lines):
            return None
        header = lines[0].entry
        assert isinstance(header, JournalHeader), "a journal begins with one"
        recorded = RecordedFeed()
        steps = [step[1:] for step in recorded_steps(lines, header, recorded)]
        if not steps:
            return None
        last = max(lines, key=lambda line: line.at.tick).at
        steps.append((OperatorCommand(INTERRUPTED), TouchMoment(last.sim_time_s, ZERO, 0.0)))
        camera, q, proximity, reach = header.before.camera, None, Proximity.FREE, Reach(True, "")
        for _at, entry in lines:
            match entry:
                case CameraChange() | Continued():
                    camera = entry.camera
                case Sample():
                    q = entry.q
                case ProximityChange():
                    proximity = entry.to
                case Reach():
                    reach = entry
        return cls(
            revision_before=header.before.revision,
            steps=tuple(steps),
            point=StartingPoint(last.tick, last.sim_time_s, 0, camera),
            q=q,
            proximity=proximity,
            reach=reach,
            feed=recorded.feed,
        )


def find_interrupted(folder: Path) -> tuple[JournalReading, InterruptedTrial] | None:
    """Return the journal of the newest trial in a folder, and where to resume it.

    None if that trial was registered or aborted: anyone who has started another trial has left an
    older one behind.
    """
    path = newest_journal(folder)
    if path is None or path.stat().st_size == 0:
        return None
    reading = read_journal(path)
    if reading.integrity is Integrity.ALTERED:
        raise InputError(f"{reading.path} is {reading.sentence}; the trial cannot be continued.")
    trial = InterruptedTrial.of(tuple(reading.lines())) if reading.entries else None
    return None if trial is None else (reading, trial)


def recorded_command(recorded: CommandDone, seed: int) -> OperatorCommand:
    """Return a recorded command; its arguments are checked, as the file may be forged."""
    name = recorded.name
    arguments = {key: value for key, value in recorded.arguments.items() if value is not None}
    if name == RECORDING_FAILED:
        return OperatorCommand(name, arguments)
    own = {}
    if name == CommandName.START_TASK:
        own = {"trialId": arguments.pop("trialId"), DRAWN_SEED: seed}
    return OperatorCommand(name, check_arguments(name, arguments) | own, 0, recorded.sender)


def recorded_steps(
    lines: Iterable[Line], header: JournalHeader, recorded: RecordedFeed
) -> Iterator[tuple[Stamp, OperatorCommand, TouchMoment]]:
    """Yield what changed the trial, and when it was recorded.

    A command whose effect is not in the journal was refused, or the server ended before the effect
    was written: no client has seen it.
    """
    seed = seed_of(header)
    for _tick, group in itertools.groupby(lines, key=lambda line: line.at.tick):
        together = list(group)
        for number, (at, entry) in enumerate(together):
            recorded.take(entry)
            if isinstance(entry, Continued):
                yield at, OperatorCommand(INTERRUPTED), TouchMoment(entry.since_s, ZERO, 0.0)
            if isinstance(entry, TracePoint):
                # It was left at the end of its tick, unlike the effect of a command.
                place = vector(map(meters, entry.position_mm))
                yield at, OperatorCommand(TRACED), TouchMoment(at.sim_time_s, place, 0.0)
            if not isinstance(entry, CommandDone) or entry.name not in _EFFECTS:
                continue
            kinds = _EFFECTS[entry.name]
            effects = (each.entry for each in together[number:])
            effect = next((each for each in effects if not kinds.isdisjoint(_kinds(each))), None)
            if effect is not None:
                # Commands are carried out at the state reached, one tick before their line.
                place = getattr(effect, "position_mm", None) or ZERO
                moment = TouchMoment(
                    sim_time=at.sim_time_s - header.tick_s,
                    tip=vector(map(meters, place)),
                    tip_clearance=getattr(effect, "clearance_mm", 0.0) / MM_PER_M,
                    direction=getattr(effect, "direction", None) or ZERO,
                    feed=recorded.before(effect),
                )
                yield at, recorded_command(entry, seed), moment


def _kinds(entry: Entry) -> tuple[str, ...]:
    """Return the kind of an entry; a registration and an abort also change the phase."""
    return ("phase", entry.kind) if isinstance(entry, PhaseChange) else (entry.kind,)
