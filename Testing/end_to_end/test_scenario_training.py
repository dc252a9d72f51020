"""A user's own scenario in a running simulator: listed, loaded over OpenIGTLink, trained on."""

from __future__ import annotations

import json
import os
import sys

import pytest

from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.scenario.library import user_library
from rastrainer.scenario.writer import new_folder, write_scenario
from Testing.domain.scenario.made_up_scenario import ball_head, made_up_scenario
from Testing.end_to_end.simulator_process import SimulatorProcess

RASTRAINER = [sys.executable, "-m", "rastrainer_simulator.cli.main", "scenario"]


@pytest.fixture
def environment(tmp_path, monkeypatch):
    """A separate home for the user, here and in the processes."""
    for name in ("HOME", "USERPROFILE"):
        monkeypatch.setenv(name, str(tmp_path))
    return dict(os.environ)


def trains_on(port, name, title):
    """Load a scenario by its name into a running simulator, and begin a trial on it."""
    with Client(port=port) as client:
        assert client.send_command(
            "Hello", {"protocolVersion": PROTOCOL_VERSION, "client": "test"}, timeout=60
        ).ok
        loaded = client.send_command("LoadScenario", {"folder": name}, timeout=60)
        assert (loaded.ok, loaded.error) == (True, "")
        assert dict(loaded.data) == {"name": name, "title": title}
        listed = client.send_command("ListTasks", {}, timeout=60)
        assert listed.data["scenario"] == name
        task = listed.data["tasks"][0]["name"]
        started = client.send_command("StartTask", {"task": task, "trainee": "anna"}, timeout=60)
        assert (started.ok, started.error) == (True, "")
        state = client.wait_for(
            "SimState", lambda message: json.loads(message.content.text)["phase"] == "running", 60
        )
        assert json.loads(state.content.text)["task"] == task


def test_a_scenario_from_the_library_is_loaded_by_name_and_trained_on(environment, tmp_path):
    with new_folder(user_library() / "ball") as made:
        write_scenario(made, made_up_scenario(), ball_head())
    options = ("--no-views", "--no-gamepad")
    with SimulatorProcess(tmp_path / "records", *options, env=environment) as simulator:
        trains_on(simulator.port, "ball", "A ball")
