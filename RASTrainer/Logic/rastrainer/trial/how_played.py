"""How a trial was played: who moved the arm, who chose the head's pose, which view was used.

It is derived from the trial's journal, entry by entry, and belongs to the trial's record.
"""

from __future__ import annotations

import math
from collections import Counter, defaultdict
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from typing import Annotated

from rastrainer.commands import CommandName
from rastrainer.journal import entries
from rastrainer.json_checks import number, object_of, text, whole_number
from rastrainer.protocol import Mode, Phase

MAX_WAY_MM = 1e9
MAX_COUNT = 10**9
HEADSET = "headset"
PACE_TOLERANCE = 0.1
MOST_PAUSES = 10
"""More would be slow motion: the trial's time stops in each."""
LEAST_IN_HEADSET = 0.9
"""Share of a trial in the mode `hmd` during which the headset is the view."""


class SeedSource(str, Enum):
    """Who chose the seed of the head's pose: nobody, `--seed` of the simulator, or a client."""

    DRAWN = "drawn"
    SESSION = "session"
    CLIENT = "client"


class MovedBy(str, Enum):
    """What moved the tip: the trainee's sticks, a client's Jog or MoveTipTo, or AlignGuide."""

    STICKS = "sticks"
    COMMANDS = "commands"
    ALIGNMENT = "alignment"


class Allowance(str, Enum):
    """Exceptions that a protocol may allow; otherwise, no step of a study accepts such a trial."""

    COMMANDS = "commands"
    CHOSEN_SEED = "chosen seed"
    REPEATED_SEED = "repeated seed"
    OTHER_SPEED = "other speed"
    PAUSES = "pauses"
    OTHER_VIEW = "other view"


@dataclass(frozen=True)
class HowPlayed:
    """How a trial was played.

    Attributes:
        started_by: Client or input device that started it, as it names itself.
        is_seed_repeated: Whether an earlier trial of the simulator had the same chosen seed.
        speed: Simulated seconds in a second, as set; 0 for as fast as possible. If the trial was
            resumed at another speed, the value farthest from 1.
        pace: Simulated seconds in a second by the clock, while the trial's own time runs: below
            `speed` if the simulator was held up, which no long wait hides.
        way_mm: Way of the tip by what moved it, a `MovedBy`.
        view_s: Time that each kind of view was looked at: `desktop`, `page`, `headset`.
    """

    started_by: Annotated[str, text(64, 0)] = ""
    seed_source: SeedSource = SeedSource.DRAWN
    is_seed_repeated: bool = False
    speed: Annotated[float, number(0, 1e6)] = 1.0
    pace: Annotated[float, number(0, 1e6)] = 1.0
    pauses: Annotated[int, whole_number(0, MAX_COUNT)] = 0
    way_mm: Annotated[
        Mapping[str, Annotated[float, number(0, MAX_WAY_MM, "mm")]], object_of(len(MovedBy))
    ] = field(default_factory=dict)
    feed_commands: Annotated[int, whole_number(0, MAX_COUNT)] = 0
    view_s: Annotated[Mapping[str, Annotated[float, number(0, MAX_COUNT, "s")]], object_of(8)] = (
        field(default_factory=dict)
    )

    @property
    def commanded_share(self) -> float:
        way = sum(self.way_mm.values())
        return self.way_mm.get(MovedBy.COMMANDS.value, 0.0) / way if way else 0.0

    def objections(self, mode: str, allows: Collection[str]) -> tuple[str, ...]:
        return tuple(why for what, why in self._objections(mode) if what.value not in allows)

    def _objections(self, mode: str) -> Iterator[tuple[Allowance, str]]:
        if self.way_mm.get(MovedBy.COMMANDS.value, 0.0) > 0.0 or self.feed_commands:
            yield (
                Allowance.COMMANDS,
                f"a client's commands moved the arm ({100.0 * self.commanded_share:.0f} % of the "
                f"way, {self.feed_commands} feeds)",
            )
        if self.seed_source is not SeedSource.DRAWN:
            by = "a client" if self.seed_source is SeedSource.CLIENT else "--seed"
            yield Allowance.CHOSEN_SEED, f"the pose of the head was chosen by {by}"
        if self.is_seed_repeated:
            yield Allowance.REPEATED_SEED, "the same pose of the head was played before"
        if self.speed != 1.0 or abs(self.pace - 1.0) > PACE_TOLERANCE:
            yield Allowance.OTHER_SPEED, f"time ran {self.pace:.2g} times as fast as the clock"
        if self.pauses > MOST_PAUSES:
            yield Allowance.PAUSES, f"it was paused {self.pauses} times"
        seen_s = sum(self.view_s.values())
        in_headset = self.view_s.get(HEADSET, 0.0) / seen_s if seen_s else 0.0
        if mode == Mode.HMD.value and in_headset < LEAST_IN_HEADSET:
            worn = f"the headset was worn {100.0 * in_headset:.0f} % of the time"
            yield Allowance.OTHER_VIEW, worn
        if mode == Mode.DESKTOP.value and in_headset > 1.0 - LEAST_IN_HEADSET:
            yield Allowance.OTHER_VIEW, "it was played in a headset"


class PlayRecording:
    """Derives from a journal's entries how its trial is played."""

    def __init__(self) -> None:
        self._how = HowPlayed()
        self._simulated_s = self._clock_s = 0.0
        self._since_complete = (0.0, 0.0)
        self._times: tuple[float, float] | None = None
        self._phase = Phase.RUNNING
        self._way_mm: dict[str, float] = defaultdict(float)
        self._view_s: Counter[str] = Counter()
        self._tip: tuple[float, ...] | None = None

    def add(self, line: entries.Line) -> None:
        self._add_time(line)
        how = self._how
        match line.entry:
            case entries.JournalHeader(session=session) | entries.Continued(session=session):
                speed = max(how.speed, session.speed or 0.0, key=lambda each: abs(each - 1.0))
                self._how = replace(how, speed=speed)
                if session.is_seeded and how.seed_source is SeedSource.DRAWN:
                    self._how = replace(self._how, seed_source=SeedSource.SESSION)
            case entries.CommandDone(
                name=CommandName.START_TASK, arguments=arguments, sender=sender
            ):
                self._how = replace(how, started_by=sender)
                if arguments.get("seed") is not None:
                    self._how = replace(self._how, seed_source=SeedSource.CLIENT)
            case entries.CommandDone(name=CommandName.FEED):
                self._how = replace(how, feed_commands=how.feed_commands + 1)
            case entries.PhaseChange(phase=Phase.PAUSED):
                self._how = replace(how, pauses=how.pauses + 1)
            case entries.Sample(tip_mm=tip, moved_by=moved_by):
                if self._tip is not None and moved_by:
                    self._way_mm[moved_by] += math.dist(tip, self._tip)
                self._tip = tip
            case entries.DisplayReport(view=view):
                # Views report once a second.
                self._view_s[view] += 1

    def played(self) -> HowPlayed:
        pace = self._simulated_s / self._clock_s if self._clock_s else self._how.speed
        return replace(self._how, pace=pace, way_mm=dict(self._way_mm), view_s=dict(self._view_s))

    def _add_time(self, line: entries.Line) -> None:
        """Add the time since the last entry, except in a pause and after the last point."""
        entry, times = line.entry, (line.at.sim_time_s, line.at.monotonic_s)
        is_after_interruption = isinstance(entry, entries.Continued)
        if self._times is not None and not (is_after_interruption or self._phase is Phase.PAUSED):
            passed = times[0] - self._times[0], times[1] - self._times[1]
            if self._phase is Phase.COMPLETE:
                # It only counts if more points follow: after an undo, or of a trace.
                waited = self._since_complete
                self._since_complete = waited[0] + passed[0], waited[1] + passed[1]
            else:
                self._count(passed)
        self._times = times
        if is_after_interruption or entry.kind == entries.PhaseChange.kind:
            assert isinstance(entry, entries.Continued | entries.PhaseChange)
            self._phase = entry.phase
            if self._phase not in (Phase.PAUSED, Phase.COMPLETE):
                if self._phase is Phase.RUNNING:
                    self._count(self._since_complete)
                self._since_complete = (0.0, 0.0)

    def _count(self, passed: tuple[float, float]) -> None:
        self._simulated_s += passed[0]
        self._clock_s += passed[1]
