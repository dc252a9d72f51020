"""`kill -9` of the server, of Slicer's side and of both: nothing acknowledged is lost."""

from __future__ import annotations

import random
import signal
import sqlite3
import time

import pytest

from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.database.study import Study
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.core.interrupted_trial import InterruptedTrial
from rastrainer_simulator.record.trial_archive import SUFFIX, find_unacknowledged
from Testing.end_to_end.finished_trials import COLIN, TRAINEE
from Testing.end_to_end.fork_server import SIMULATOR, SLICER_SIDE, shared_fork_server
from Testing.end_to_end.simulator_process import READY
from Testing.end_to_end.surviving_player import NOT_REPORTED, Killing, SurvivingPlayer
from Testing.free_port import free_port

TIMEOUT_S = 180.0


class Lab:
    """A folder of records and one of Slicer's side, and their processes."""

    def __init__(self, folder):
        self.records, self.output = folder / "records", folder / "slicer"
        self._config = str(folder / "config")
        self.port = free_port()

    def start_simulator(self):
        """Return a function that ends it by a signal."""
        words = ("--no-views", "--speed", "10", "--port", str(self.port))
        simulator = shared_fork_server(SIMULATOR).fork(
            "simulator", "--records", str(self.records), "--config", self._config, *words
        )
        ready = simulator.next_line()
        assert ready.startswith(READY), ready
        self.port = int(ready.removeprefix(READY))
        return simulator.end

    def start_slicer(self):
        """Return Slicer's side, which waits for more trials than there are."""
        words = ("--assets", str(asset_path()), "--output", str(self.output), "--trials", "100000")
        slicer = shared_fork_server(SLICER_SIDE).fork(
            "--port", str(self.port), *words, "--timeout", "1000"
        )
        slicer.drain_output()
        return slicer

    @property
    def journals(self):
        return sorted(self.records.glob(f"*{SUFFIX}"))

    def stored(self):
        """Return how many trials the study holds, and how many of them have their truth."""
        try:
            with Study.open(self.output / "study.db") as study:
                trials = study.history(TRAINEE)
        except (InputError, sqlite3.Error):
            return 0, 0
        assert len({trial.record.trial_id for trial in trials}) == len(trials)
        return len(trials), sum(trial.true_tre_mm is not None for trial in trials)


def check_records(lab, player):
    """Every acknowledged touch is in a journal that is complete or recovered.

    Return the UUIDs of the registered trials and the touches in their journals; a registration
    whose answer the kill has swallowed was never acknowledged, but counts.
    """
    open_trials = 0
    found = {}
    for path in lab.journals:
        if path.stat().st_size == 0:
            continue
        reading = read_journal(path)
        assert reading.integrity is not Integrity.ALTERED
        if not reading.entries:
            continue
        trial = reading.header.trial_id
        if registered := reading.of_kind("registered"):
            assert reading.integrity is Integrity.INTACT
            points = registered[-1]["record"]["points"]
            found[trial] = [(p["label"], tuple(p["positionMm"])) for p in points]
        elif InterruptedTrial.of(tuple(reading.lines())) is not None:
            open_trials += 1
    assert found.keys() >= player.registered
    for trial in player.registered:
        kept = player.kept[trial]
        assert [label for label, _ in found[trial]] == [label for label, _ in kept]
        # A touch whose answer the kill has swallowed was never acknowledged, but counts.
        assert all(
            position in (NOT_REPORTED, recorded)
            for (_, position), (_, recorded) in zip(kept, found[trial], strict=True)
        )
    assert open_trials == 0
    return found


def deliver_the_rest(lab, trials):
    """Have trials stored and acknowledged, then their truths revealed, and end Slicer's side.

    An answer that came too late on a busy machine is asked for again over the next connection.
    """
    slicer = lab.start_slicer()
    wait_for_study(lab, lambda stored: stored[0] == trials and not find_unacknowledged(lab.records))
    slicer.end(signal.SIGKILL)
    slicer = lab.start_slicer()
    wait_for_study(lab, lambda stored: stored == (trials, trials))
    slicer.end(signal.SIGKILL)


def wait_for_study(lab, is_complete):
    """Wait for stored trials; give up only if nothing more arrives."""
    stored, give_up = None, 0.0
    while not is_complete(now := lab.stored()):
        if now != stored:
            stored, give_up = now, time.monotonic() + TIMEOUT_S
        assert time.monotonic() < give_up, stored
        time.sleep(0.1)


@pytest.mark.parametrize(
    ("kills", "resumed"), [(2, 1), pytest.param(200, 70, marks=pytest.mark.soak)]
)
def test_a_trainee_whose_server_and_slicer_are_killed_loses_no_touch_and_doubles_no_trial(
    tmp_path, kills, resumed
):
    """Slicer's side is killed, alone or at once with the server; then all is delivered."""
    lab, rng = Lab(tmp_path), random.Random(8)
    player = SurvivingPlayer(load_scenario(COLIN), rng)
    end_simulator, slicer = lab.start_simulator(), lab.start_slicer()
    killed = 0

    def kill(with_server):
        nonlocal killed
        killed += 1
        slicer.end(signal.SIGKILL)
        if with_server:
            end_simulator(signal.SIGKILL)

    while killed < kills or player.resumed < resumed:
        with_server = rng.random() < 0.7
        killing = Killing(rng, lambda both=with_server: kill(both), at_commands=with_server)
        lives = player.play(lab.port, killing, 1000 if with_server else 1)
        assert lives is not with_server
        if with_server:
            end_simulator = lab.start_simulator()
        if killing.is_done:
            slicer = lab.start_slicer()
    assert player.play(lab.port, None, 1)
    slicer.end(signal.SIGKILL)
    deliver_the_rest(lab, len(check_records(lab, player)))
    end_simulator(signal.SIGTERM)
    with Study.open(lab.output / "study.db") as study:
        records = [trial.record for trial in study.history(TRAINEE)]
    stored = {
        record.trial_id: [(point.label, tuple(point.position_mm)) for point in record.points]
        for record in records
    }
    assert len(stored) == len(records)
    assert stored == check_records(lab, player)
