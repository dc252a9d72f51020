"""The journal of a drill: a separate file, whose header has the task `decide`.

The drill's seed gives its cases, so it is secret until the end, as the seed of a trial is.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from datetime import datetime, timezone

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.journal.entries import DrillEnd, Entry, Line, Stamp, iso
from rastrainer.json_records import record_to_json
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.journal_writer import Journal, RecordError
from rastrainer_simulator.record.trial_archive import ArchivedTrial
from rastrainer_simulator.texts.texts import say


class DrillJournal:
    """Writes the journal of a drill.

    An entry that is refused is not written later: it did not count.
    """

    def __init__(self, journal: Journal, seed: int, control_loop: ControlLoop) -> None:
        self._journal, self._seed, self._control_loop = journal, seed, control_loop

    def write(self, entry: Entry, sync: bool = True) -> None:
        state = self._control_loop.latest
        at = Stamp.now(state.tick, state.sim_time)
        try:
            self._journal.write_lines([Line(at, entry)], sync)
        except RecordError as error:
            self._journal.forget_unwritten()
            raise RecordError(say("decide.not recorded", reason=str(error))) from None
        finally:
            # An open file could not be deleted with its trainee.
            self._journal.close()

    def finish(self, record: Callable[[str], DrillRecord]) -> None:
        """Record the end of a drill, and have its record delivered."""
        finished = record(iso(datetime.now(timezone.utc)))
        self.write(DrillEnd(record_to_json(finished), self._seed))
        sealed = replace(finished, journal_sha256=self._journal.last_hash)
        self._control_loop.deliver(ArchivedTrial(sealed, self._journal))
