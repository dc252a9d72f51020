"""No trial starts on the old head or settings while the simulator loads others."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager

import pytest

from rastrainer.igtl.client import Client
from rastrainer.journal.journal_file import read_journal
from rastrainer.scenario.writer import new_folder, write_scenario
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.record.trial_archive import SUFFIX
from rastrainer_simulator.replay.resimulation import replay
from rastrainer_simulator.texts.texts import ENGLISH
from rastrainer_simulator.virtual.scripted_trial import send_hello
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario
from Testing.end_to_end.simulator_process import MenuView, ViewedSimulator, items_of
from Testing.end_to_end.window_process import wait_until

pytestmark = pytest.mark.skipif(os.name == "nt", reason="Windows has no named pipes")

LOADING = ENGLISH["being set up"]
PATIENCE_S = 120.0
MORE_THAN_AT_ONCE = 6
"""Starts that must not all succeed; refused starts do not count."""
HELD = """
from pathlib import Path
from rastrainer_simulator.server import server

def held(scenario, *others, load=server.load_setup, Path=Path, **named):
    if scenario is not None:
        Path({pipe!r}).read_bytes()
    return load(scenario, *others, **named)

server.load_setup = held
"""
"""After its start, the simulator loads a scenario when a test has opened and closed the pipe."""


class HeldSimulator(ViewedSimulator):
    """A simulator that loads a scenario only when a test lets it."""

    def __init__(self, folder):
        self._pipe = folder / "pipe"
        os.mkfifo(self._pipe)
        self.records = folder / "records"
        self.first = HELD.format(pipe=str(self._pipe))
        super().__init__(self.records)

    @contextmanager
    def being_loaded(self) -> Iterator[None]:
        """Wait until something is being loaded, and let it finish at the end."""
        # Opens once the simulator opens it, too.
        with self._pipe.open("wb"):
            yield


class Peer(Client):
    """A client whose commands may be answered later."""

    def __init__(self, port):
        super().__init__(port=port)
        self._pool = ThreadPoolExecutor(max_workers=1)
        send_hello(self, "test")

    def ask(self, command, **arguments):
        return self.send_command(command, arguments, timeout=PATIENCE_S)

    def begin(self, command, **arguments) -> Future:
        return self._pool.submit(self.ask, command, **arguments)

    def start(self, task):
        return self.ask("StartTask", task=task, trainee="P07")

    def close(self):
        super().close()
        self._pool.shutdown()


def phase(peer):
    """Return the phase of a trial that has begun."""

    def has_begun(message):
        return json.loads(message.content.text)["phase"] != "idle"

    return json.loads(peer.wait_for("SimState", has_begun, PATIENCE_S).content.text)["phase"]


@pytest.fixture
def ball(tmp_path):
    with new_folder(tmp_path / "ball") as made:
        write_scenario(made, made_up_scenario(), ball_head())
    return tmp_path / "ball"


@pytest.fixture
def simulator(tmp_path):
    with HeldSimulator(tmp_path) as simulator:
        yield simulator


@pytest.fixture
def instructor(simulator):
    with Peer(simulator.port) as peer:
        yield peer


@pytest.fixture
def other(simulator):
    with Peer(simulator.port) as peer:
        yield peer


@pytest.fixture
def menu(simulator, loop_thread):
    with MenuView(loop_thread, simulator) as view:
        yield view


def test_a_trial_waits_until_the_head_is_loaded_no_matter_who_starts_it(
    simulator, instructor, other, menu, ball
):
    menu.go_to_experiment("P07")
    menu.until_menu("experiment", lambda menu: items_of(menu)["trial-run"]["isEnabled"])
    loading = instructor.begin("LoadScenario", folder=str(ball))
    with simulator.being_loaded():
        refused = [other.start("task-1") for _ in range(MORE_THAN_AT_ONCE)]
        refused.append(other.ask("LoadScenario", folder="colin27"))
        assert {(answer.ok, answer.error) for answer in refused} == {(False, LOADING)}
        assert other.ask("ListTasks").data["scenario"] == "colin27"
        assert not loading.done()
        items = items_of(
            menu.until_menu("experiment", lambda menu: not items_of(menu)["trial-run"]["isEnabled"])
        )
        assert items["trial-run"]["help"] == LOADING
        assert items["scenario"]["value"] == "Colin27 head"
    assert loading.result(PATIENCE_S).data["name"] == "ball"
    task = other.ask("ListTasks").data["tasks"][0]["name"]
    items = items_of(
        menu.until_menu(
            "experiment", lambda menu: items_of(menu).get(task, {}).get("help") != LOADING
        )
    )
    assert items["scenario"]["value"] == "A ball"
    started = other.start(task)
    assert (started.ok, started.error) == (True, "")
    assert other.ask("MoveTipTo", positionMm=[450.0, 30.0, 420.0]).ok
    assert other.ask("Abort").ok
    assert simulator.stop()[0] == 0
    # The refused starts left nothing behind that the trial depends on.
    (journal,) = simulator.records.glob(f"*{SUFFIX}")
    assert replay(read_journal(journal), load_setup(ball)).difference is None


def test_a_client_that_leaves_while_its_scenario_is_loading_blocks_nobody(simulator, other, ball):
    with Peer(simulator.port) as leaving:
        leaving.begin("LoadScenario", folder=str(ball))
        loading = simulator.being_loaded()
        loading.__enter__()
    assert other.start("task-1").error == LOADING
    loading.__exit__(None, None, None)
    wait_until(lambda: other.ask("ListTasks").data["scenario"] == "ball", "the head")
    task = other.ask("ListTasks").data["tasks"][0]["name"]
    wait_until(lambda: other.start(task).error != LOADING, "the trial")
    assert phase(other) == "running"
