"""Whether a delivered trial follows from its journal.

The record names the hash of its line, by which the simulator is bound to all lines up to it before
a registration is submitted; these are checked once the truth is revealed. A whole journal that is
consistent can still be invented: `rastrainer replay --verify` simulates it again, and even then
nobody knows whose hands moved the sticks.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.journal.folder import JournalNumber
from rastrainer.journal.journal_file import NO_LINE, DamagedLineError, decode_line
from rastrainer.journal.recording import Recording, WholeRecording
from rastrainer.json_records import record_from_json
from rastrainer.motion.trajectory import Touch, Trajectory
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.scenario.scenario import Scenario, method_of
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.record import TrialRecord

SAME = 1e-6
"""Numbers that were computed again may differ by this, in mm and s, or relatively."""
SAMPLES_APART_S, TIP_APART_MM = 0.1, 50.0
"""A touch is on the tip's path: so near, in time and place, to a recorded posture."""
_AFTER_THE_TRIAL = frozenset({"registration", "scored", "acknowledged"})
Entry = Mapping[str, Any]


def check_journal(
    record: TrialRecord, truth: RevealedTruth, journal: bytes, scenario: Scenario
) -> None:
    """Check a trial, and the truth that was revealed, by its journal."""
    try:
        entries = _entries(journal, record.journal_sha256)
        registered = next(e for e in entries if e["sha256"] == record.journal_sha256)
        _check_record(record, entries[0], registered)
        _check_touches(record, [e for e in entries if e["n"] < registered["n"]])
        again = trial_motion(Recording.of(entries).trajectory())
        _require(
            again.keys() == record.motion.keys()
            and all(
                math.isclose(value, record.motion[name], rel_tol=SAME, abs_tol=SAME)
                for name, value in again.items()
            ),
            "the motion",
        )
        written = np.reshape(registered["truth"]["headToWorld"], (4, 4))
        of_seed = scenario.perturbed_head_to_world(registered["seed"])
        _require(
            np.allclose(written, truth.matrix, rtol=0.0, atol=SAME)
            and np.allclose(written, of_seed, rtol=0.0, atol=SAME),
            "the head's pose",
        )
    except InputError:
        raise
    except (KeyError, TypeError, ValueError, AttributeError, OverflowError) as error:
        raise InputError(f"Its journal holds an entry that is not one ({error!r}).") from None


def _entries(journal: bytes, sealed: str) -> list[Entry]:
    """Return the entries of a trial, without later entries; they hold the sealed line."""
    entries: list[Entry] = []
    previous = NO_LINE
    for number, line in enumerate(journal.splitlines(), start=1):
        try:
            entry = decode_line(line, number, previous)
        except DamagedLineError as error:
            raise InputError(f"Line {number} of its journal was altered: {error}.") from None
        if entry["kind"] in _AFTER_THE_TRIAL:
            break
        entries.append(entry)
        previous = entry["sha256"]
    if not sealed or sealed not in {entry["sha256"] for entry in entries}:
        raise InputError("Its journal is not the one that was announced with it.")
    return entries


def _check_record(record: TrialRecord, header: Entry, registered: Entry) -> None:
    written = record_from_json(TrialRecord, registered["record"])
    _require(written == replace(record, journal_sha256=""), "the record")
    number = record_from_json(JournalNumber, header)
    method = method_of(header["method"]["name"] if "method" in header else None)
    told = (header["trialId"], header["trainee"], header["task"], header["mode"], header["utc"])
    _require(
        told == (record.trial_id, record.trainee, record.task, record.mode, record.started_utc)
        and header["scenario"]["name"] == record.scenario
        and (number.number, number.series) == (record.number, record.series)
        and method is record.method,
        "who played what",
    )


def _check_touches(record: TrialRecord, entries: Sequence[Entry]) -> None:
    """Check the points that registered the trial, their times, and that the tip was there."""
    tick_s = entries[0]["tickS"]
    kept = _Measured.of(entries).trajectory()
    last = {entry["label"]: entry for entry in entries if entry["kind"] == "touch"}
    found = [
        (touch.label, touch.position_mm, last[touch.label]["simTimeS"] - tick_s, last[touch.label])
        for touch in kept.touches
    ]
    _require(len(found) == len(record.points), "the touches")
    for (label, place, time_s, entry), point in zip(found, record.points, strict=True):
        is_same = (label, entry["utc"]) == (point.label, point.utc)
        is_there = np.allclose(place, point.position_mm, rtol=0.0, atol=SAME)
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
    tips = WholeRecording.of(entries).trajectory()
    _require(all(_is_on_path(touch, tips) for touch in tips.touches), "the tip's path")


class _Measured(WholeRecording):
    """The touches and the trace where they were measured, on skin that may have shifted.

    The time of a trial that was registered again includes the checkpoints before.
    """

    def add(self, entry: Entry) -> None:
        measured = entry.get("measuredMm")
        super().add(entry if measured is None else {**entry, "positionMm": measured})


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
