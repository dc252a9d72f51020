"""Lines of journals, with made-up values where a test gives none."""

from collections.abc import Iterable

from rastrainer.journal.entries import (
    AT_ZERO,
    FORMAT,
    FORMAT_VERSION,
    REAL_TIME,
    AcceptedTouch,
    Entry,
    JournalHeader,
    Line,
    PhaseChange,
    ProximityChange,
    RecordedContent,
    Sample,
    Stamp,
)
from rastrainer.journal.journal_file import NO_LINE, encode_line
from rastrainer.protocol import Phase, Proximity

UTC = "2024-05-17T09:30:00.000Z"
HERE = {"clearance_mm": 0.0, "depth_mm": 0.0}


def at(time_s: float, entry: Entry, tick: int = 1) -> Line:
    return Line(Stamp(tick, time_s, time_s, UTC), entry)


def header(tick_s: float = 0.004, **given) -> JournalHeader:
    values = {
        "format": FORMAT,
        "version": FORMAT_VERSION,
        "number": 1,
        "series": "",
        "trial_id": "5c6f1d0e-6a4e-4c37-9d0c-0f6a2f7d9b11",
        "trainee": "P01",
        "task": "task-1",
        "shortest_path_mm": None,
        "mode": "desktop",
        "tick_s": tick_s,
        "session": REAL_TIME,
        "before": AT_ZERO,
        "scenario": RecordedContent("colin27", "0" * 64),
        "robot": "iiwa",
        "settings": {},
        "versions": {},
    }
    return JournalHeader(**{**values, **given})


def sample(tip_mm=(0.0, 0.0, 0.0), **given) -> Sample:
    return Sample(**{"q": (0.0,) * 7, **HERE, "tip_mm": tip_mm, "moved_by": "", **given})


def touch(label: str, position_mm=(1.0, 2.0, 3.0), kept: int = 1, **given) -> AcceptedTouch:
    return AcceptedTouch(
        **{**HERE, "label": label, "position_mm": position_mm, "kept": kept, **given}
    )


def phase(phase: Phase, next_point: str | None = None, **given) -> PhaseChange:
    texts = dict.fromkeys(("trial_id", "trainee", "task", "mode", "instruction"), "")
    return PhaseChange(phase=phase, next_point=next_point, **texts, **given)


def proximity(before: Proximity, after: Proximity, depth_mm: float | None = None):
    return ProximityChange(from_=before, to=after, clearance_mm=0.0, depth_mm=depth_mm)


def journal_bytes(lines: Iterable[Line]) -> bytes:
    """Return the content of a journal's file."""
    written, previous = [], NO_LINE
    for n, line in enumerate(lines, start=1):
        encoded, previous = encode_line(n, previous, line.to_json())
        written.append(encoded)
    return b"".join(written)
