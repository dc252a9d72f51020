"""Measurements of drills by a client, or by a reader of the folder, who does not look at a case.

`decision_traffic.csv` has it of stored cases, as measured in real sessions: pages as they are sent,
the journal on the disk, and the times of answers. `python -m Testing.error_rates.decision_traffic`
measures the forms that it lacks.
"""

from __future__ import annotations

import itertools
import json
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from unittest import mock

import numpy as np

from rastrainer.decision.drill_record import CASES, Decision, Fault
from rastrainer.journal.folder import DRILL_SUFFIX
from rastrainer.json_records import record_to_json
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.decision import forms
from rastrainer_simulator.decision.cases import CaseMaker
from rastrainer_simulator.decision.drill import Drill, begin_drill
from rastrainer_simulator.flow.session.head_slices import head_slices
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.screen import SliceMark
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from rastrainer_simulator.vectors import in_meters
from Testing.error_rates.decisions import FILE as CASES_FILE
from Testing.error_rates.decisions import Shown
from Testing.error_rates.row_files import add_row, stored_rows

FILE = Path(__file__).with_name("decision_traffic.csv")
FORMS = 40
KEYS = set(itertools.product(range(FORMS), range(CASES)))
"""Form and number of each stored case."""


@dataclass(frozen=True)
class Traffic:
    """Measurements of a case before its decision.

    Attributes:
        waited_ms: from the end of the case before until this one is shown.
        checked_ms, sliced_ms: until the journal has a check, and until the images are sent.
        rows: that can be checked.
        first_label: of the first point, as a number; 0 if it is none.
        order: mean distance from a point to the next one, relative to the mean of all pairs.
        slices_bytes, contour_points: of the images, without the residuals and the trace.
        digits: mean number of characters of a fiducial's place.
        journal_bytes, journal_ns: added to the journal, and the last digits of its time of change.
    """

    form: int
    number: int
    is_sound: int
    waited_ms: float
    checked_ms: float
    sliced_ms: float
    rows: int
    first_label: int
    order: float
    slices_bytes: int
    contour_points: int
    digits: float
    journal_bytes: int
    journal_ns: int


def of_form(number: int, rows: list[Shown], maker: CaseMaker, loop: ControlLoop) -> list[Traffic]:
    """Play a stored form, and return the measurements of its cases."""
    made = tuple(maker.case(row.seed, Fault(row.fault)) for row in rows)
    with (
        tempfile.TemporaryDirectory() as name,
        mock.patch.object(forms, "draw_form", return_value=made),
    ):
        drill = begin_drill(Path(name), "P01", "desktop", loop, number, ())
        (path,) = Path(name).glob(f"*{DRILL_SUFFIX}")
        return [_measured(number, place, row, drill, path) for place, row in enumerate(rows)]


def _measured(number: int, place: int, row: Shown, drill: Drill, path: Path) -> Traffic:
    if drill.decided is not None:
        drill.next_case()
    before = path.stat().st_size
    waited_ms = _until(drill, lambda: drill.is_ready)
    case = drill.case
    start = time.perf_counter()
    marks = {SliceMark.TARGET: case.target_mm}
    slices = record_to_json(head_slices(Texts(LANGUAGES["en"]), case, case.target_mm, marks, ""))
    sliced_ms = 1e3 * (time.perf_counter() - start)
    kept = [
        [line for line in each["lines"] if line["mark"] not in ("residual", "trace", "point")]
        for each in slices["slices"]
    ]
    start = time.perf_counter()
    drill.check("Nose tip" if "Nose tip" in case.places else next(iter(case.places)))
    case.tip_for(next(iter(case.places.values())))
    checked_ms = 1e3 * (time.perf_counter() - start) + _until(drill, lambda: bool(drill.checks))
    after = path.stat()
    balls = case.truly(case.fixed_mm).round(1)
    apart = np.linalg.norm(case.fixed_mm[:, None] - case.fixed_mm, axis=2)
    steps = np.linalg.norm(np.diff(case.fixed_mm, axis=0), axis=1)
    drill.decide(Decision.STOP, 50)
    _until(drill, lambda: drill.decided is not None)
    return Traffic(
        form=number,
        number=place,
        is_sound=int(row.is_sound),
        waited_ms=round(waited_ms, 3),
        checked_ms=round(checked_ms, 3),
        sliced_ms=round(sliced_ms, 3),
        rows=len(case.places),
        first_label=int(case.labels[0]) if case.labels[0].isdigit() else 0,
        order=round(float(steps.mean() / apart[np.triu_indices(len(apart), 1)].mean()), 3),
        slices_bytes=len(json.dumps(kept)),
        contour_points=sum(len(line["points"]) for lines in kept for line in lines),
        digits=round(len(json.dumps([in_meters(ball) for ball in balls.tolist()])) / len(balls), 2),
        journal_bytes=after.st_size - before,
        journal_ns=after.st_mtime_ns % 10**6,
    )


def _until(drill: Drill, is_there: Callable[[], bool]) -> float:
    """Let a drill go on until something is there; return after how many ms."""
    start = time.perf_counter()
    while not is_there():
        drill.advance(0.0)
    return 1e3 * (time.perf_counter() - start)


def main() -> None:
    known = {each.form for each in stored_rows(FILE, Traffic)} if FILE.exists() else set()
    shown: list[Shown] = stored_rows(CASES_FILE, Shown)
    setup = load_setup(None)
    maker = CaseMaker(setup.scenario)
    with tempfile.TemporaryDirectory() as folder:
        loop = ControlLoop(Simulation(setup, 3), Path(folder), speed=None)
        for number in sorted(set(range(FORMS)) - known):
            rows = sorted((r for r in shown if r.form == number), key=lambda row: row.number)
            for each in of_form(number, rows, maker, loop):
                add_row(FILE, each)
        loop.stop()


if __name__ == "__main__":
    main()
