"""Whether a delivered trial follows from its journal.

The record names the hash of its line, by which the simulator is bound to all lines up to it before
a registration is submitted; these are checked once the truth is revealed. A whole journal that is
consistent can still be invented: `rastrainer replay --verify` simulates it again, and even then
nobody knows whose hands moved the sticks.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.journal import entries
from rastrainer.journal.journal_file import NO_LINE, DamagedLineError, decode_line
from rastrainer.journal.recording import Recording, WholeRecording
from rastrainer.json_records import record_from_json
from rastrainer.motion.trajectory import Touch, Trajectory
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.record import TrialRecord

SAME = 1e-6
"""Numbers that were computed again may differ by this, in mm and s, or relatively."""
SAMPLES_APART_S, TIP_APART_MM = 0.1, 50.0
"""A touch is on the tip's path: so near, in time and place, to a recorded posture."""


def check_journal(
    record: TrialRecord, truth: RevealedTruth, journal: bytes, scenario: Scenario
) -> None:
    """Check a trial, and the truth that was revealed, by its journal."""
    try:
        lines, place = _lines(journal, record.journal_sha256)
        header, registered = lines[0], lines[place].entry
        if not isinstance(header.entry, entries.JournalHeader) or not isinstance(
            registered, entries.Registered
        ):
            raise InputError("Its journal holds no trial that was registered.")
        _check_record(record, header.entry, header.at.utc, registered)
        _check_touches(record, lines[:place])
        again = trial_motion(Recording.of(lines).trajectory())
        _require(
            again.keys() == record.motion.keys()
            and all(
                math.isclose(value, record.motion[name], rel_tol=SAME, abs_tol=SAME)
                for name, value in again.items()
            ),
            "the motion",
        )
        written = registered.truth.head_to_world
        of_seed = scenario.perturbed_head_to_world(registered.seed or 0)
        _require(
            np.allclose(written, truth.matrix, rtol=0.0, atol=SAME)
            and np.allclose(written, of_seed, rtol=0.0, atol=SAME),
            "the head's pose",
        )
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise InputError(f"Its journal holds an entry that is not one ({error!r}).") from None


def _lines(journal: bytes, sealed: str) -> tuple[list[entries.Line], int]:
    """Return the lines of a trial, without any that follow it, and the index of the sealed line."""
    lines: list[entries.Line] = []
    previous, place = NO_LINE, None
    for number, line in enumerate(journal.splitlines(), start=1):
        try:
            values = decode_line(line, number, previous)
        except DamagedLineError as error:
            raise InputError(f"Line {number} of its journal was altered: {error}.") from None
        found, previous = entries.read_line(values), values["sha256"]
        if isinstance(
            found.entry, entries.FinalRegistration | entries.Scored | entries.Acknowledged
        ):
            break
        if previous == sealed:
            place = len(lines)
        lines.append(found)
    if place is None:
        raise InputError("Its journal is not the one that was announced with it.")
    return lines, place


def _check_record(
    record: TrialRecord,
    header: entries.JournalHeader,
    started_utc: str,
    registered: entries.Registered,
) -> None:
    written = record_from_json(TrialRecord, registered.record)
    _require(written == replace(record, journal_sha256=""), "the record")
    told = (header.trial_id, header.trainee, header.task, header.mode, started_utc)
    _require(
        told == (record.trial_id, record.trainee, record.task, record.mode, record.started_utc)
        and header.scenario.name == record.scenario
        and (header.number, header.series) == (record.number, record.series)
        and header.registration_method is record.method,
        "who played what",
    )


def _check_touches(record: TrialRecord, lines: Sequence[entries.Line]) -> None:
    header = lines[0].entry
    assert isinstance(header, entries.JournalHeader)
    kept = _Measured.of(lines).trajectory()
    last = {
        line.entry.label: line.at for line in lines if isinstance(line.entry, entries.AcceptedTouch)
    }
    found = [
        (touch, last[touch.label].sim_time_s - header.tick_s, last[touch.label].utc)
        for touch in kept.touches
    ]
    _require(len(found) == len(record.points), "the touches")
    for (touch, time_s, utc), point in zip(found, record.points, strict=True):
        is_same = (touch.label, utc) == (point.label, point.utc)
        is_there = np.allclose(touch.position_mm, point.position_mm, rtol=0.0, atol=SAME)
        is_then = math.isclose(time_s, point.sim_time_s, abs_tol=SAME)
        _require(is_same and is_there and is_then, f"the touch of {point.label}")
    traced = [(*touch.position_mm,) for touch in kept.traced]
    is_drawn = len(traced) == len(record.trace) and np.allclose(
        np.reshape(traced, (-1, 3)), record.trace_mm, rtol=0.0, atol=SAME
    )
    _require(is_drawn, "the trace")
    counts = (len(kept.refused), kept.undone)
    _require(counts == (record.rejected_touches, record.undone_touches), "the refused touches")
    completed_s = (kept.traced or kept.touches)[-1].time_s
    _require(math.isclose(completed_s, record.completion_time_s, abs_tol=SAME), "the time")
    tips = WholeRecording.of(lines).trajectory()
    _require(all(_is_on_path(touch, tips) for touch in tips.touches), "the tip's path")


class _Measured(WholeRecording):
    """The touches and the trace where they were measured, on skin that may have shifted.

    The time of a trial that was registered again includes the checkpoints before.
    """

    def add(self, line: entries.Line) -> None:
        entry = line.entry
        if isinstance(entry, entries.AcceptedTouch | entries.Rejected | entries.TracePoint):
            entry = replace(entry, position_mm=entry.measured_mm or entry.position_mm)
        super().add(entries.Line(line.at, entry))


def _is_on_path(touch: Touch, path: Trajectory) -> bool:
    if not len(path.times_s):
        return False
    nearest = int(np.abs(path.times_s - touch.time_s).argmin())
    apart_s = abs(float(path.times_s[nearest]) - touch.time_s)
    apart_mm = float(np.linalg.norm(path.tip_mm[nearest] - np.array(touch.position_mm)))
    return apart_s <= SAMPLES_APART_S and apart_mm <= TIP_APART_MM


def _require(is_so: bool, what: str) -> None:
    if not is_so:
        raise InputError(f"Its journal tells otherwise: {what}.")
