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
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.interrupted_trial import InterruptedTrial
from rastrainer_simulator.record.trial_archive import SUFFIX, TrialArchive, find_unacknowledged
from Testing.end_to_end.finished_trials import COLIN, TRAINEE, write_finished_trials
from Testing.end_to_end.process_nursery import SIMULATOR, SLICER_SIDE, Nursery
from Testing.end_to_end.simulator_process import READY
from Testing.end_to_end.surviving_player import NOT_REPORTED, Killing, SurvivingPlayer
from Testing.free_port import free_port

TIMEOUT_S = 180.0


@pytest.fixture(scope="module")
def simulators(tmp_path_factory):
    """A nursery of simulators."""
    with Nursery(SIMULATOR, tmp_path_factory.mktemp("simulators")) as nursery:
        yield nursery


@pytest.fixture(scope="module")
def slicer_sides(tmp_path_factory):
    """A nursery of Slicer's sides."""
    with Nursery(SLICER_SIDE, tmp_path_factory.mktemp("slicer-sides")) as nursery:
        yield nursery


class Lab:
    """A folder of records and one of Slicer's side, and their processes."""

    def __init__(self, folder, nursery, slicer_nursery=None, speed=10):
        self.records, self.output = folder / "records", folder / "slicer"
        self._config = str(folder / "config")
        self._nursery, self._slicer_nursery = nursery, slicer_nursery
        self._speed = str(speed)
        self.port = free_port()

    def start_simulator(self):
        """Return a function that ends it by a signal."""
        words = ("--no-views", "--speed", self._speed, "--port", str(self.port))
        simulator = self._nursery.fork(
            "simulator", "--records", str(self.records), "--config", self._config, *words
        )
        ready = simulator.next_line()
        assert ready.startswith(READY), ready
        self.port = int(ready.removeprefix(READY))
        return simulator.end

    def start_slicer(self):
        """Return Slicer's side, which waits for more trials than there are."""
        words = ("--assets", str(asset_path()), "--output", str(self.output), "--trials", "100000")
        return self._slicer_nursery.fork("--port", str(self.port), *words, "--timeout", "1000")

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


def kill_servers(lab, kills, resumed, seed):
    """Continue playing through a number of kills, then one trial to its end; return the player.

    A kill between two trials leaves none to resume: there are more kills until so many were.
    """
    rng = random.Random(seed)
    player = SurvivingPlayer(load_scenario(COLIN), rng)
    killed = 0
    while killed < kills or player.resumed < resumed:
        end = lab.start_simulator()
        assert not player.play(lab.port, Killing(rng, lambda end=end: end(signal.SIGKILL)), 1000)
        killed += 1
    end = lab.start_simulator()
    assert player.play(lab.port, None, 1)
    end(signal.SIGTERM)
    return player


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


def check_offers(lab, player, replayed):
    """Trials that Slicer's side has not fetched are offered, and some can be replayed."""
    offered = {record.trial_id for record in TrialArchive(lab.records).unacknowledged()}
    assert offered >= player.registered
    chosen = [path for path in lab.journals if path.stem.partition("_")[2] in player.registered]
    for path in chosen[:replayed]:
        assert main(["replay", str(path), "--verify"]) == 0


def test_a_repeatedly_killed_server_resumes_where_the_trainee_was(tmp_path, simulators):
    lab = Lab(tmp_path, simulators)
    player = kill_servers(lab, kills=8, resumed=4, seed=3)
    check_records(lab, player)
    check_offers(lab, player, replayed=0)


@pytest.mark.soak
def test_three_hundred_kills_of_the_server_lose_no_acknowledged_touch(tmp_path, simulators, capsys):
    lab = Lab(tmp_path, simulators)
    player = kill_servers(lab, kills=300, resumed=150, seed=4)
    check_records(lab, player)
    check_offers(lab, player, replayed=2)
    with capsys.disabled():
        touches = sum(map(len, player.kept.values()))
        print(
            f"\n300 kills: {len(player.registered)} trials, {touches} touches, {player.resumed} "
            "times resumed"
        )


def kill_slicer(lab, kills, seed, trials, also_server):
    """Kill Slicer's side, and the server with it or at another time, until all is stored."""
    rng = random.Random(seed)
    wanted = set(write_finished_trials(lab.records, range(1, trials + 1)))
    end_simulator = lab.start_simulator()
    slicer = lab.start_slicer()
    for _ in range(kills):
        # While it starts, or while trials arrive: they are offered every two seconds.
        if rng.random() < 0.9:
            while '"connected"' not in (line := slicer.next_line()):
                assert line, "Slicer's side has ended"
        time.sleep(rng.uniform(0.0, 2.5))
        slicer.end(signal.SIGKILL)
        if also_server and rng.random() < 0.5:
            end_simulator(signal.SIGKILL)
            end_simulator = lab.start_simulator()
        slicer = lab.start_slicer()
    deliver_the_rest(lab, slicer, trials)
    end_simulator(signal.SIGTERM)
    with Study.open(lab.output / "study.db") as study:
        assert {trial.record.trial_id for trial in study.history(TRAINEE)} == wanted
    assert TrialArchive(lab.records).unacknowledged() == ()
    assert all(read_journal(path).integrity is Integrity.INTACT for path in lab.journals)


def deliver_the_rest(lab, slicer, trials):
    """Have trials stored and acknowledged, then their truths revealed, and end Slicer's side.

    An answer that came too late on a busy machine is asked for again over the next connection.
    """
    slicer.drain_output()
    wait_for_study(lab, lambda stored: stored[0] == trials and not find_unacknowledged(lab.records))
    slicer.end(signal.SIGKILL)
    slicer = lab.start_slicer()
    slicer.drain_output()
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


def kill_both_during_play(lab, kills, resumed, seed):
    """Play on while Slicer's side is killed, alone or at once with the server; return the player.

    Then play one trial to its end and have all delivered. As of `kill_servers`, `resumed` is how
    many trials were resumed at least.
    """
    rng = random.Random(seed)
    player = SurvivingPlayer(load_scenario(COLIN), rng)
    end_simulator, slicer = lab.start_simulator(), lab.start_slicer()
    slicer.drain_output()
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
            slicer.drain_output()
    assert player.play(lab.port, None, 1)
    slicer.end(signal.SIGKILL)
    deliver_the_rest(lab, lab.start_slicer(), len(check_records(lab, player)))
    end_simulator(signal.SIGTERM)
    return player


def check_study(lab, player):
    """Every registered trial is in the study once, with the touches of its journal."""
    with Study.open(lab.output / "study.db") as study:
        records = [trial.record for trial in study.history(TRAINEE)]
    stored = {
        record.trial_id: [(point.label, tuple(point.position_mm)) for point in record.points]
        for record in records
    }
    assert len(stored) == len(records)
    assert stored == check_records(lab, player)


def test_a_trainee_whose_server_and_slicer_are_killed_at_once_resumes_and_loses_no_touch(
    tmp_path, simulators, slicer_sides
):
    lab = Lab(tmp_path, simulators, slicer_sides)
    player = kill_both_during_play(lab, kills=2, resumed=1, seed=8)
    check_study(lab, player)


@pytest.mark.soak
def test_three_hundred_kills_of_both_sides_during_play_lose_no_touch_and_duplicate_no_trial(
    tmp_path, simulators, slicer_sides, capsys
):
    lab = Lab(tmp_path, simulators, slicer_sides)
    player = kill_both_during_play(lab, kills=300, resumed=100, seed=9)
    check_study(lab, player)
    with capsys.disabled():
        touches = sum(map(len, player.kept.values()))
        print(
            f"\n300 kills of both: {len(player.registered)} trials, {touches} touches, "
            f"{player.resumed} times resumed"
        )


@pytest.mark.soak
def test_slicers_side_and_the_server_killed_at_any_moment_deliver_every_trial_once(
    tmp_path, simulators, slicer_sides
):
    lab = Lab(tmp_path, simulators, slicer_sides, speed=1)
    kill_slicer(lab, kills=2, seed=6, trials=3, also_server=True)


@pytest.mark.soak
@pytest.mark.parametrize("also_server", [False, True], ids=["alone", "with the server"])
def test_three_hundred_kills_of_slicers_side_lose_and_duplicate_no_trial(
    tmp_path, simulators, slicer_sides, also_server
):
    lab = Lab(tmp_path, simulators, slicer_sides, speed=1)
    kill_slicer(lab, kills=300, seed=7, trials=400, also_server=also_server)
