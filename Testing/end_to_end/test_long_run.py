"""Hours of training in a row: memory and descriptors stay flat, and no log contains an error."""

from __future__ import annotations

import contextlib
import json
import random
import re
import sys
import time
from pathlib import Path
from statistics import median
from typing import NamedTuple

import pytest

from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer_simulator.record.trial_archive import SUFFIX
from Testing.benchmarks.row import resident_mb
from Testing.end_to_end.finished_trials import COLIN, TRAINEE
from Testing.end_to_end.lab import SlicerProcess
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.end_to_end.stream_trainee import WatchingView
from Testing.end_to_end.surviving_player import SurvivingPlayer
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient

pytestmark = pytest.mark.skipif(
    sys.platform != "linux", reason="memory and descriptors are read where Linux tells them"
)

TROUBLE = re.compile(r"error|traceback|critical", re.IGNORECASE)
SPEED = 8.0
MAX_GROWTH_MB = 8.0
"""Allowed growth of either process between the first fifth and the last, for caches and studies."""


class Usage(NamedTuple):
    """A process at one moment: MB of memory in use and open descriptors."""

    resident_mb: float
    descriptors: int

    @classmethod
    def of(cls, pid: int) -> Usage:
        return cls(resident_mb(pid), len(list(Path(f"/proc/{pid}/fd").iterdir())))


def train(folder: Path, end: float) -> tuple[list[Usage], list[Usage], list]:
    """Play trial after trial, each over a separate connection, with a view and Slicer's side.

    Return the use of each process after every trial, and the errors that either reports.
    """
    records = folder / "records"
    simulators, slicers, problems = [], [], []
    player = SurvivingPlayer(load_scenario(COLIN), random.Random(1))
    with contextlib.ExitStack() as stack:
        thread = stack.enter_context(LoopThread())
        simulator = stack.enter_context(
            ViewedSimulator(records, "--speed", str(SPEED), "--view-port", "0")
        )
        slicer_says = stack.enter_context((folder / "slicer-says").open("w+"))
        slicer = SlicerProcess(simulator.port, folder / "slicer", 1_000_000, slicer_says)
        stack.callback(slicer.kill)
        while time.monotonic() < end:
            with ViewClient(thread, simulator.url, simulator.key) as view:
                WatchingView(view)
                assert player.play(simulator.port, None, 1)
                lines = slicer.events_until("trial")
                problems += [line for line in lines if line["event"] == "problem"]
                simulators.append(Usage.of(simulator.pid))
                slicers.append(Usage.of(slicer.pid))
        slicer.kill()
        status, said = simulator.stop()
        slicer_says.seek(0)
        said += slicer_says.read()
    assert status == 0
    check_nothing_lost(folder, player.registered)
    errors = [line for line in said.splitlines() if TROUBLE.search(line)] + logged_errors(folder)
    return simulators, slicers, errors + problems


def logged_errors(folder: Path) -> list[str]:
    """Return the lines of the simulator's log that report an error."""
    log = folder.glob("records-config/logs/*.log*")
    lines = [line for path in log for line in path.read_text().splitlines()]
    return [line for line in lines if json.loads(line)["level"] in ("error", "critical")]


def check_nothing_lost(folder: Path, registered: set[str]) -> None:
    """Every trial that was played is in the study once, and its journal is whole."""
    with Study.open(folder / "slicer" / "study.db") as study:
        stored = [trial.record.trial_id for trial in study.history(TRAINEE)]
    assert sorted(stored) == sorted(registered)
    journals = list((folder / "records").glob(f"*{SUFFIX}"))
    assert len(journals) == len(registered)
    assert all(read_journal(path).integrity is Integrity.INTACT for path in journals)


def growth_mb(usages: list[Usage]) -> float:
    """Return how much more memory is in use in the last fifth than in the second, MB."""
    fifth = max(len(usages) // 5, 1)
    early, late = usages[fifth : 2 * fifth], usages[-fifth:]
    return median(use.resident_mb for use in late) - median(use.resident_mb for use in early)


@pytest.mark.soak
def test_two_hours_of_training_do_not_increase_memory_or_descriptors(tmp_path):
    simulators, slicers, errors = train(tmp_path, time.monotonic() + 7200.0 / SPEED)
    assert errors == []
    for name, usages in (("simulator", simulators), ("Slicer's side", slicers)):
        more = usages[-1].descriptors - usages[0].descriptors
        assert growth_mb(usages) <= MAX_GROWTH_MB, name
        # A journal that is being closed and a view that is leaving may still be counted.
        assert more <= 3, name
