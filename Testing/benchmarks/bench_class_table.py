"""The table of a class: read again after a trial, and read when nothing has changed."""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from uuid import uuid4

from rastrainer.study.database.study import Study
from rastrainer_simulator.board.class_table import ClassReader, class_table
from Testing.benchmarks.row import row
from Testing.domain.trial.trial_records import gentle_score, make_record
from Testing.simulator.board.class_study import play_class

TRAINEES, TRIALS = 30, 60
UNCHANGED = 200


def rows(quick: bool) -> list[dict]:
    """Return `class_table.changed`, after a trial was stored, and `class_table.unchanged`."""
    names = [f"T{number:03d}" for number in range(1, TRAINEES + 1)]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "study.db"
        play_class(path, names, TRIALS)
        reader = ClassReader(path)
        changed = []
        for number in range(5 if quick else 20):
            _store_one(path, names[number])
            changed.append(_milliseconds(lambda: class_table(reader.read(), "en")))
        unchanged = [_milliseconds(reader.read) for _ in range(UNCHANGED)]
        reader.close()
    return [
        row(f"class_table.changed.{TRAINEES}", changed, "ms"),
        row(f"class_table.unchanged.{TRAINEES}", unchanged, "ms"),
    ]


def _store_one(path: Path, trainee: str) -> None:
    record = make_record(trialId=str(uuid4()), trainee=trainee)
    with Study.open(path) as study:
        study.add_trial(record, score=gentle_score(80.0, 0.3))


def _milliseconds(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return 1e3 * (time.perf_counter() - began)
