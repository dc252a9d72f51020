"""The ordinary server process, worked by a gamepad alone."""

from __future__ import annotations

import json
import time

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.journal.journal_file import read_journal
from Testing.end_to_end.virtual_gamepad import SimulatorWithGamepad

TIMEOUT_S = 120.0
AGAIN_S = 0.5
"""Taps that come faster than the simulator takes them would wait in a row, the sticks behind."""


class Watch:
    """What an OpenIGTLink client sees of the simulator."""

    def __init__(self, client):
        self._client = client

    def state(self):
        message = self._client.wait_for("SimState", timeout=TIMEOUT_S)
        return json.loads(message.content.text)

    def until(self, condition):
        def fits(message):
            return condition(json.loads(message.content.text))

        self._client.wait_for("SimState", fits, timeout=TIMEOUT_S)

    def sees(self, instruction):
        return instruction in self.state()["instruction"]

    def tip(self):
        return np.array(self._client.wait_for("ToolTipToWorld").content.matrix)[:3, 3]

    def until_the_arm(self, moves):
        """Wait until the arm moves, or is at rest."""
        give_up = time.monotonic() + TIMEOUT_S
        while True:
            before = self.tip()
            time.sleep(0.3)
            if moves == (np.linalg.norm(self.tip() - before) > 0.01):
                return
            assert time.monotonic() < give_up


def test_a_gamepad_alone_begins_a_task_moves_the_arm_and_may_be_unplugged(tmp_path):
    (tmp_path / "records-config").mkdir()
    (tmp_path / "records-config" / "preferences.json").write_text('{"fine": 5}')
    simulator = SimulatorWithGamepad(tmp_path / "records", "--view-port", "0", "--seed", "5")
    with simulator, Client(port=simulator.port) as client:
        watch = Watch(client)
        watch.until(lambda state: state["phase"] == "idle")
        # Start training, three pages of introduction, the controls, and the ID: "A".
        for button in ("a", "a", "a", "a", "a", "a", "a", *["dpdown"] * 5, "a"):
            simulator.tap(button)
        for button in (*["dpdown"] * 5, "a"):
            simulator.tap(button)
        watch.until(lambda state: state["phase"] == "running")
        state = watch.state()
        assert (state["trainee"], state["task"], state["mode"]) == ("A", "trial-run", "desktop")
        # The presenter follows the trial a moment later: its answer to a touch shows that.
        give_up = time.monotonic() + TIMEOUT_S
        while not watch.sees("Too far from point 1"):
            assert time.monotonic() < give_up, "no touch was taken"
            simulator.tap("a")
            time.sleep(AGAIN_S)
        while not (strengths := {strength for strength, _ in simulator.felt() if strength > 0}):
            assert time.monotonic() < give_up, "nothing vibrated"
        assert strengths == {45874 / 65535}
        simulator.move(leftx=0.8)
        watch.until_the_arm(moves=True)
        simulator.plug_out()
        watch.until_the_arm(moves=False)
        watch.until(lambda state: state["phase"] == "paused")
        simulator.plug_in()
        while watch.state()["phase"] != "running":
            assert time.monotonic() < give_up, "the trial was not resumed"
            simulator.tap("a")
            time.sleep(AGAIN_S)
        simulator.move(leftx=-0.8)
        watch.until_the_arm(moves=True)
        simulator.move(leftx=0.0)
        simulator.tap("start")
        watch.until(lambda state: state["phase"] == "paused")
        assert simulator.stop() == (0, "")
    (path,) = (tmp_path / "records").glob("*.journal")
    reading = read_journal(path)
    assert reading.header["settings"]["teleoperation"]["fine_speed"] == 0.005
    assert {entry["operator"] for entry in reading.of_kind("input")} <= {"gamepad", ""}
