"""The trial that a server's end cut short and that nobody has gone on with: it counts as aborted.

Otherwise whoever ends the simulator in the middle of a bad trial would be rid of it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rastrainer.aborted_trial import AbortedTrial
from rastrainer.errors import InputError
from rastrainer.journal.journal_reader import JournalReading
from rastrainer.journal.recording import Recording
from rastrainer.protocol import AbortReason, Phase
from rastrainer.trial_record import TouchedPoint
from rastrainer_simulator.record.interrupted_trial import InterruptedTrial


def left_trial(reading: JournalReading) -> AbortedTrial | None:
    """Return the record of the trial that a journal leaves open; None where it is over.

    Raises:
        InputError: the entries are not those of a trial.
    """
    if not reading.entries or InterruptedTrial.of(reading.entries) is None:
        return None
    try:
        return _left_trial(reading.entries)
    except (KeyError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise InputError(f"An entry of the journal is not as it should be ({error!r}).") from None


def _left_trial(entries: tuple[Mapping[str, Any], ...]) -> AbortedTrial:
    header, trajectory = entries[0], Recording.of(entries).trajectory()
    told = {entry["label"]: entry for entry in entries if entry["kind"] == "touch"}
    points = tuple(
        TouchedPoint(
            label=touch.label,
            position_mm=tuple(told[touch.label]["positionMm"]),
            sim_time_s=told[touch.label]["simTime"] - header["tickS"],
            utc=told[touch.label]["utc"],
        )
        for touch in trajectory.touches
    )
    phase = [entry["phase"] for entry in entries if entry["kind"] in ("phase", "continued")][-1]
    if phase == Phase.COMPLETE.value:
        elapsed_s = trajectory.touches[-1].time_s
    else:
        # Samples are taken while the trial's time runs.
        elapsed_s = float(trajectory.times_s[-1]) if len(trajectory.times_s) else 0.0
    record = AbortedTrial(
        trial_id=header["trialId"],
        trainee=header["trainee"],
        task=header["task"],
        mode=header["mode"],
        scenario=header["scenario"]["name"],
        started_utc=header["utc"],
        aborted_utc=entries[-1]["utc"],
        elapsed_s=elapsed_s,
        phase=phase,
        reason=AbortReason.NOT_GONE_ON_WITH.value,
        points=points,
        rejected_touches=len(trajectory.refused),
        undone_touches=trajectory.undone,
        versions=header["versions"],
        touch_rule=header["settings"]["training"]["touch_rule"],
    )
    return AbortedTrial.from_json(record.to_json())
