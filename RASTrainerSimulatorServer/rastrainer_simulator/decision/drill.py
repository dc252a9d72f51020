"""A drill of decisions: its cases one after the other, each with a clock, checks and a decision.

Everything is recorded before it counts, so that a drill is continued by its recorded entries. Time
comes with `advance`.
"""

from __future__ import annotations

import uuid
from collections.abc import Collection, Iterable, Iterator, Sequence
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from datetime import datetime, timezone
from pathlib import Path
from typing import TYPE_CHECKING

from rastrainer.decision.drill_record import (
    CASE_S,
    CASES,
    CHECK_S,
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
    Entry,
    JournalHeader,
    ReadImages,
    iso,
)
from rastrainer.journal.folder import DRILL_SUFFIX
from rastrainer.journal.journal_file import Integrity, file_stamp, read_journal
from rastrainer.json_checks import accepted, pseudonym
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import DECIDE
from rastrainer_simulator.decision.drill_journal import DrillJournal
from rastrainer_simulator.decision.prepared_cases import prepared_cases
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.journal_writer import Journal, RecordError
from rastrainer_simulator.record.trial_context import versions
from rastrainer_simulator.texts.texts import say

if TYPE_CHECKING:
    from rastrainer_simulator.decision.cases import DecisionCase

CLOCK_S = 2.0
"""How often the clock is recorded, so that a kill gains at most so much; and how long after a
failure it is tried again."""
TIP = "tip"
"""Name of a checked place where the trainee held the tip."""


class Drill:
    """A trainee's drill.

    Attributes:
        time_s: of the present case, with its checks.
        cases: decided so far, in order.
        decided: the present case, once decided; then its truth may be shown.
        is_ready: whether the present case is made and shown; it is being prepared until then.
        is_finished: whether the record of the drill is on the disk, to be delivered.
    """

    def __init__(
        self,
        header: JournalHeader,
        started_utc: str,
        cases: Sequence[Future[DecisionCase]],
        journal: DrillJournal,
        recorded: Iterable[Entry] = (),
    ) -> None:
        """Begin a drill, or continue after its `recorded` entries."""
        self.header = header
        self.trainee, self.mode, self.trial_id = header.trainee, header.mode, header.trial_id
        self.count = CASES
        self._started_utc, self._made, self._journal = started_utc, cases, journal
        self.cases: tuple[DecidedCase, ...] = ()
        self._begin_case()
        self.is_finished = self._is_stuck = False
        self._since_s = 0.0
        for entry in recorded:
            self._take(entry)

    def _begin_case(self) -> None:
        self.decided: DecidedCase | None = None
        self._case: DecisionCase | None = None
        self.time_s = 0.0
        self.checks: tuple[str, ...] = ()
        self.has_read_images = self._is_shown = False

    @property
    def number(self) -> int:
        """The number of the present case, from 1."""
        return len(self.cases) + (self.decided is None)

    @property
    def is_ready(self) -> bool:
        return self._case is not None

    @property
    def case(self) -> DecisionCase:
        assert self._case is not None, "the case is being prepared"
        return self._case

    @property
    def left_s(self) -> float:
        return max(0.0, CASE_S - self.time_s)

    @property
    def is_over(self) -> bool:
        return len(self.cases) >= self.count

    def advance(self, dt: float) -> None:
        """Show a case that was made, run the clock of an undecided one, or finish the drill.

        Time stands still while the disk takes nothing: RecordError is raised every `CLOCK_S`.
        """
        self._since_s += dt
        is_due = self._since_s >= CLOCK_S
        if self._is_stuck and not is_due:
            return
        if self.is_over and not self.is_finished:
            with self._trying():
                self._journal.finish(self.record)
            self.is_finished = True
        elif self._case is None and self._made[self.number - 1].done():
            self._show()
        elif self._case is not None and self.decided is None:
            if is_due:
                self._note(CaseClock(self.number, self.time_s + dt), sync=False)
            else:
                self.time_s += dt

    def check(self, place: str) -> None:
        """Check a place of the case, or the `TIP`, for `CHECK_S` of the case's clock."""
        if place not in (*self.case.places, TIP):
            raise InputError(f"The case has no place {place!r}.")
        if self.left_s < CHECK_S:
            raise InputError(say("decide.no time"))
        self._note(CheckedPlace(place, self.time_s + CHECK_S))

    def read_images(self) -> None:
        if not self.has_read_images:
            self._note(ReadImages(self.time_s))

    def decide(
        self, decision: Decision, confidence: int, suspected: Fault | None = None
    ) -> DecidedCase:
        """Decide the case; nothing is suspected where the decision is to proceed."""
        case = self.case
        decided = DecidedCase(
            seed=case.seed,
            fault=case.fault,
            method=case.method,
            limit_mm=case.limit_mm,
            true_error_mm=case.true_error_mm,
            expected_error_mm=case.expected.expected_mm,
            residual_mm=case.residual_mm,
            difficulty=case.difficulty,
            checks=self.checks,
            has_read_images=self.has_read_images,
            decision=decision,
            confidence=confidence,
            suspected=None if decision is Decision.PROCEED else suspected,
            time_s=self.time_s,
        )
        values = record_to_json(decided)
        record_from_json(DecidedCase, values)
        self._note(CaseDecided(values))
        return decided

    def next_case(self) -> None:
        assert self.decided is not None, "the case is to be decided"
        assert not self.is_over, "no case is to follow"
        self._begin_case()

    def record(self, completed_utc: str) -> DrillRecord:
        return DrillRecord(
            trial_id=self.trial_id,
            trainee=self.trainee,
            mode=self.mode,
            scenario=self.header.scenario.name,
            started_utc=self._started_utc,
            completed_utc=completed_utc,
            cases=self.cases,
            versions=self.header.versions,
        )

    def _show(self) -> None:
        with self._trying():
            case = self._made[self.number - 1].result()
            if not self._is_shown:
                self._note(CaseClock(self.number, 0.0))
        self._case = case

    def _note(self, entry: Entry, sync: bool = True) -> None:
        """Record what happened to an undecided case; only then it counts."""
        assert self.decided is None, "the case is decided"
        with self._trying():
            self._journal.write(entry, sync)
        self._take(entry)

    @contextmanager
    def _trying(self) -> Iterator[None]:
        self._is_stuck, self._since_s = True, 0.0
        yield
        self._is_stuck = False

    def close(self) -> None:
        """Leave the drill, to be continued with the present clock."""
        with suppress(RecordError):
            if self.is_ready and self.decided is None:
                self._note(CaseClock(self.number, self.time_s))
        for each in self._made:
            each.cancel()

    def _take(self, entry: Entry) -> None:
        match entry:
            case CaseClock():
                if self.decided is not None and not self.is_over:
                    self._begin_case()
                self.time_s, self._is_shown = entry.time_s, True
            case CheckedPlace():
                self.checks += (entry.place,)
                self.time_s = entry.time_s
            case ReadImages():
                self.has_read_images = True
            case CaseDecided():
                self.decided = record_from_json(DecidedCase, entry.case)
                self.cases += (self.decided,)


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
    header = JournalHeader(
        format=FORMAT,
        version=FORMAT_VERSION,
        number=0,
        series="",
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
    drill_journal = DrillJournal(journal, seed, control_loop)
    try:
        drill_journal.write(header)
    except RecordError:
        journal.discard()
        raise
    return Drill(header, now, prepared_cases(setup.scenario, seed, seen), drill_journal)


def continue_drill(path: Path, control_loop: ControlLoop, seen: Collection[int]) -> Drill:
    """Continue the drill of a journal, which was begun on the present scenario."""
    reading = read_journal(path)
    if reading.integrity is Integrity.ALTERED or reading.seed is None:
        raise InputError(f"{path} is {reading.sentence}; the drill cannot be continued.")
    first, *lines = reading.lines()
    seed, scenario = reading.seed, control_loop.setup.scenario
    journal = DrillJournal(Journal.reopened(reading), seed, control_loop)
    cases = prepared_cases(scenario, seed, seen)
    return Drill(reading.header, first.at.utc, cases, journal, (line.entry for line in lines))
