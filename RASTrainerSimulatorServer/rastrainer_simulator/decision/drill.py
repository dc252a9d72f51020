"""A drill of decisions: its cases one after the other, each with a clock, checks and a decision.

Everything is recorded before it counts, so that a drill is continued by its recorded entries. Time
comes with `advance`. The journal is a separate file, whose header has the task `decide`. The
drill's seed gives its cases, so it is secret until the end, as the seed of a trial is.
"""

from __future__ import annotations

import uuid
from collections import deque
from collections.abc import Callable, Collection, Iterable
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import suppress
from dataclasses import fields, replace
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from numpy.random import default_rng

import rastrainer
from rastrainer.decision.drill_record import (
    CASE_S,
    CASES,
    CHECK_S,
    CaseTruth,
    DecidedCase,
    Decision,
    DrillRecord,
    Fault,
)
from rastrainer.errors import InputError
from rastrainer.journal.entries import (
    FORMAT,
    FORMAT_VERSION,
    CaseClock,
    CaseDecided,
    CheckedPlace,
    DrillEnd,
    Entry,
    JournalHeader,
    Line,
    ReadImages,
    Stamp,
    iso,
)
from rastrainer.journal.folder import DRILL_SUFFIX, UNNUMBERED, newest_journal, number_of
from rastrainer.journal.journal_file import Integrity, file_stamp, read_journal
from rastrainer.json_checks import accepted, pseudonym
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import DECIDE
from rastrainer.scenario.scenario import Scenario
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.journal_writer import Journal, RecordError
from rastrainer_simulator.record.trial_archive import ArchivedTrial
from rastrainer_simulator.record.trial_context import versions
from rastrainer_simulator.texts.texts import say

if TYPE_CHECKING:
    from rastrainer_simulator.decision.cases import DecisionCase

CLOCK_S = 2.0
"""How often the clock is recorded, so that a kill gains at most so much; and how long after a
failure it is tried again."""
TIP = "tip"
"""Name of a checked place where the trainee held the tip."""


def _nothing() -> None:
    pass


class Drill:
    """A trainee's drill; an action counts once the loop's writer has it on the disk.

    Attributes:
        time_s: of the present case, with its checks.
        cases: decided so far, in order.
        decided: the present case, once decided; then its truth may be shown.
        is_finished: whether the record of the drill is on the disk, to be delivered.
    """

    def __init__(
        self,
        header: JournalHeader,
        started_utc: str,
        journal: Journal,
        seed: int,
        control_loop: ControlLoop,
        seen: Collection[int],
        recorded: Iterable[Entry] = (),
    ) -> None:
        """Begin a drill of cases that were not `seen`, or continue after its `recorded` entries."""
        self.header, self.trainee, self.trial_id = header, header.trainee, header.trial_id
        self._started_utc, self._journal, self._seed = started_utc, journal, seed
        self._control_loop = control_loop
        thread = ThreadPoolExecutor(max_workers=1, thread_name_prefix="cases")
        self._form = thread.submit(_form, control_loop.setup.scenario, seed, seen)
        thread.shutdown(wait=False)
        self._being_written: deque[tuple[Entry, Future[None], Callable[[], None]]] = deque()
        self.count = CASES
        self.cases: tuple[DecidedCase, ...] = ()
        self._begin_case()
        self.is_finished = False
        self._since_s = self._waits_s = 0.0
        for entry in recorded:
            self._take(entry)

    def _begin_case(self) -> None:
        self.decided: DecidedCase | None = None
        self.time_s = self._recorded_s = 0.0
        self.checks: tuple[str, ...] = ()
        self.has_read_images = self._is_shown = False

    @property
    def number(self) -> int:
        """The number of the present case, from 1."""
        return len(self.cases) + (self.decided is None)

    @property
    def is_ready(self) -> bool:
        """Whether the present case is shown; it is being prepared until then."""
        return self._is_shown and self._form.done() and self._form.exception() is None

    @property
    def case(self) -> DecisionCase:
        assert self.is_ready, "the case is being prepared"
        return self._form.result()[self.number - 1]

    @property
    def left_s(self) -> float:
        return max(0.0, CASE_S - self.time_s)

    @property
    def is_recorded(self) -> bool:
        """Whether the disk has all that was done."""
        return not self._being_written

    @property
    def is_over(self) -> bool:
        return len(self.cases) >= self.count

    def advance(self, dt: float) -> None:
        """Show a case that was made, run the clock of an undecided one, or finish the drill.

        Time stands still while the disk takes nothing: RecordError is raised every `CLOCK_S`.
        """
        self._count_written()
        self._since_s += dt
        self._waits_s -= dt
        if self._waits_s > 0.0:
            return
        if self.is_ready and self.decided is None:
            self.time_s += dt
            if self.is_recorded and self._since_s >= CLOCK_S:
                self._write(CaseClock(self.number, self.time_s), sync=False)
        elif self.is_recorded and self.is_over and not self.is_finished:
            self._write(self._ended())
        elif self.is_recorded and self._form.done() and self._form.exception() is not None:
            self._waits_s = CLOCK_S
            self._form.result()
        elif self.is_recorded and self._form.done() and not self._is_shown:
            self._write(CaseClock(self.number, 0.0))

    def check(self, place: str, then: Callable[[], None] = _nothing) -> None:
        """Check a place of the case, or the `TIP`, for `CHECK_S` of the case's clock.

        Once that counts, do something more.
        """
        if place not in (*self.case.places, TIP):
            raise InputError(f"The case has no place {place!r}.")
        if self.left_s < CHECK_S:
            raise InputError(say("decide.no time"))
        self._write(CheckedPlace(place, self.time_s + CHECK_S), then=then)

    def read_images(self, then: Callable[[], None] = _nothing) -> None:
        if self.has_read_images:
            then()
        else:
            self._write(ReadImages(self.time_s), then=then)

    def decide(self, decision: Decision, confidence: int, suspected: Fault | None = None) -> None:
        """Decide the case; nothing is suspected where the decision is to proceed."""
        decided = DecidedCase(
            **{each.name: getattr(self.case, each.name) for each in fields(CaseTruth)},
            checks=self.checks,
            has_read_images=self.has_read_images,
            decision=decision,
            confidence=confidence,
            suspected=None if decision is Decision.PROCEED else suspected,
            time_s=self.time_s,
        )
        values = record_to_json(decided)
        record_from_json(DecidedCase, values)
        self._write(CaseDecided(values))

    def next_case(self) -> None:
        assert self.decided is not None, "the case is to be decided"
        assert not self.is_over, "no case is to follow"
        self._begin_case()

    def close(self) -> None:
        """Leave the drill, to be continued with the present clock."""
        with suppress(RecordError):
            if self.is_ready and self.decided is None:
                self._write(CaseClock(self.number, self.time_s))
        # The trainee who continues it does so by the journal.
        wait([future for _, future, _ in self._being_written])
        self._form.cancel()

    def _ended(self) -> DrillEnd:
        record = DrillRecord(
            trial_id=self.trial_id,
            trainee=self.trainee,
            mode=self.header.mode,
            scenario=self.header.scenario.name,
            started_utc=self._started_utc,
            completed_utc=iso(datetime.now(timezone.utc)),
            cases=self.cases,
            versions=self.header.versions,
            number=self.header.number,
            series=self.header.series,
        )
        return DrillEnd(record_to_json(record), self._seed)

    def _write(self, entry: Entry, sync: bool = True, then: Callable[[], None] = _nothing) -> None:
        """Have an entry recorded; a decision is the last one of its case."""
        is_decided = any(isinstance(each, CaseDecided) for each, *_ in self._being_written)
        if is_decided or (self.decided is not None and not isinstance(entry, DrillEnd)):
            return
        self._since_s, write = 0.0, self._control_loop.write
        future = write(lambda: _append(self._journal, entry, self._control_loop, sync))
        self._being_written.append((entry, future, then))
        self._count_written()

    def _count_written(self) -> None:
        while self._being_written and self._being_written[0][1].done():
            entry, future, then = self._being_written.popleft()
            try:
                future.result()
            except RecordError:
                self._waits_s = CLOCK_S
                if isinstance(entry, CaseClock):
                    self.time_s = self._recorded_s
                raise
            self._take(entry)
            then()

    def _take(self, entry: Entry) -> None:
        match entry:
            case CaseClock():
                if self.decided is not None and not self.is_over:
                    self._begin_case()
                self._recorded_s, self._is_shown = entry.time_s, True
            case CheckedPlace():
                self.checks += (entry.place,)
                self._recorded_s = entry.time_s
            case ReadImages():
                self.has_read_images = True
            case CaseDecided():
                self.decided = record_from_json(DecidedCase, entry.case)
                self.cases += (self.decided,)
            case DrillEnd():
                self.is_finished = True
        self.time_s = max(self.time_s, self._recorded_s)


def _append(journal: Journal, entry: Entry, control_loop: ControlLoop, sync: bool) -> None:
    """Write an entry, and after the last one have the drill delivered; in the writer's thread.

    An entry that is refused is not written later: it did not count.
    """
    state = control_loop.latest
    try:
        journal.write_lines([Line(Stamp.now(state.tick, state.sim_time), entry)], sync)
    except RecordError as error:
        journal.forget_unwritten()
        raise RecordError(say("decide.not recorded", reason=str(error))) from None
    finally:
        # An open file could not be deleted with its trainee.
        journal.close()
    if isinstance(entry, DrillEnd):
        record = record_from_json(DrillRecord, entry.record)
        sealed = replace(record, journal_sha256=journal.last_hash)
        control_loop.archive.add(ArchivedTrial(sealed, journal))


def _form(scenario: Scenario, seed: int, seen: Collection[int]) -> tuple[DecisionCase, ...]:
    """Return the cases of a drill; it takes seconds. All are made before the first is shown."""
    # Only now: their import of scipy would delay the simulator's start.
    from rastrainer_simulator.decision.cases import CaseMaker
    from rastrainer_simulator.decision.forms import draw_form

    cases = draw_form(CaseMaker(scenario), default_rng(seed), seen)
    # The first cut imports packages for seconds, which would stop the page.
    cases[0].contours(cases[0].target_mm)
    return cases


def begin_drill(
    folder: Path,
    trainee: str,
    mode: str,
    control_loop: ControlLoop,
    seed: int,
    seen: Collection[int],
) -> Drill:
    """Begin a drill on the present scenario; its cases are none of those whose seeds were `seen`.

    Raise RecordError if the disk is full.
    """
    setup, now = control_loop.setup, iso(datetime.now(timezone.utc))
    newest = newest_journal(folder, DRILL_SUFFIX)
    numbered = (UNNUMBERED if newest is None else number_of(newest)).following()
    header = JournalHeader(
        format=FORMAT,
        version=FORMAT_VERSION,
        number=numbered.number,
        series=numbered.series,
        trial_id=str(uuid.uuid4()),
        trainee=accepted(pseudonym, trainee, "trainee"),
        task=DECIDE,
        shortest_path_mm=None,
        mode=mode,
        tick_s=control_loop.tick_s,
        session=control_loop.playing,
        before=control_loop.latest.starting_point,
        versions=versions(),
        **setup.recorded(),
    )
    journal = Journal(folder / f"{file_stamp(now)}_{header.trial_id}{DRILL_SUFFIX}", seed)
    try:
        control_loop.write(lambda: _append(journal, header, control_loop, True)).result()
    except RecordError:
        journal.discard()
        raise
    return Drill(header, now, journal, seed, control_loop, seen)


def continues_on(header: JournalHeader, setup: SimulationSetup) -> bool:
    """Return whether a drill can be continued; another version may draw other cases."""
    is_same = header.versions.get("rastrainer") == rastrainer.__version__
    return is_same and not setup.difference(header)


def continue_drill(path: Path, control_loop: ControlLoop, seen: Collection[int]) -> Drill:
    """Continue the drill of a journal, which was begun on the present scenario."""
    reading = read_journal(path)
    if reading.integrity is Integrity.ALTERED or reading.seed is None:
        raise InputError(f"{path} is {reading.sentence}; the drill cannot be continued.")
    first, *lines = reading.lines()
    journal, recorded = Journal.reopened(reading), (line.entry for line in lines)
    drill = reading.header, first.at.utc, journal, reading.seed
    return Drill(*drill, control_loop, seen, recorded)
