"""Hours of training in a row: memory and descriptors stay flat, and no log contains an error."""

from __future__ import annotations

import contextlib
import json
import random
import re
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import pytest

from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer_simulator.assets import asset_path
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


@dataclass(frozen=True)
class Usage:
    """A process at one moment: MB of memory in use and open descriptors."""

    resident_mb: float
    descriptors: int

    @classmethod
    def of(cls, pid: int) -> Usage:
        return cls(resident_mb(pid), len(list(Path(f"/proc/{pid}/fd").iterdir())))


@dataclass(frozen=True)
class Run:
    """The results of a long run.

    Attributes:
        simulator, slicer: use of each process after every trial.
        errors: lines of the simulator's log, and of either process's stderr, that tell of one.
        problems: reported by Slicer's side.
        trials: that were played.
    """

    simulator: list[Usage]
    slicer: list[Usage]
    errors: list[str]
    problems: list[dict]
    trials: int


def train(folder: Path, is_enough: Callable[[int], bool]) -> Run:
    """Play trial after trial, each over a separate connection, with a view and Slicer's side.

    `is_enough` is asked with the number of trials played, before each trial.
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
        slicer = SlicerProcess(
            *("--port", str(simulator.port), "--trials", "1000000", "--timeout", "100000"),
            *("--assets", str(asset_path()), "--output", str(folder / "slicer")),
            errors=slicer_says,
        )
        stack.callback(slicer.kill)
        while not is_enough(len(simulators)):
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
    return Run(simulators, slicers, errors, problems, len(player.registered))


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


def check_flat(run: Run) -> None:
    assert run.errors == run.problems == []
    for usages in (run.simulator, run.slicer):
        assert growth_mb(usages) <= MAX_GROWTH_MB
        # A journal that is being closed and a view that is leaving may still be counted.
        assert usages[-1].descriptors <= usages[0].descriptors + 3


def growth_text(run: Run) -> str:
    parts = [
        f"{name} {growth_mb(usages):+.1f} MB to {usages[-1].resident_mb:.0f}, "
        f"{usages[-1].descriptors - usages[0].descriptors:+d} descriptors"
        for name, usages in (("simulator", run.simulator), ("Slicer's side", run.slicer))
    ]
    return f"\n{run.trials} trials: {'; '.join(parts)}"


@pytest.mark.soak
def test_two_hours_of_training_do_not_increase_memory_or_descriptors(tmp_path, capsys):
    end = time.monotonic() + 7200.0 / SPEED
    run = train(tmp_path, lambda _played: time.monotonic() > end)
    with capsys.disabled():
        print(growth_text(run))
    check_flat(run)
