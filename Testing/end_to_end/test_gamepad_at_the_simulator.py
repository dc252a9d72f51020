"""The ordinary server process, worked by a gamepad alone."""

from __future__ import annotations

import json
import time

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.journal.journal_file import read_journal
from Testing.end_to_end.hands import GamepadHands
from Testing.web.place import Place

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
        tip = self._client.wait_for("ToolTipToWorld", timeout=TIMEOUT_S)
        return np.array(tip.content.matrix)[:3, 3]

    def until_moved_from(self, place):
        """Wait until the tip is elsewhere, mm."""

        def is_away(message):
            return np.linalg.norm(np.array(message.content.matrix)[:3, 3] - place) > 0.01

        self._client.wait_for("ToolTipToWorld", is_away, timeout=TIMEOUT_S)


def test_a_gamepad_alone_begins_a_task_moves_the_arm_and_may_be_unplugged(tmp_path):
    with (
        Place(tmp_path, has_gamepad=True, fine=5, order="fixed") as place,
        Client(port=place.simulator.port) as client,
    ):
        simulator, watch = place.simulator, Watch(client)
        trainee = place.trainee(GamepadHands(simulator))
        trainee.begin("trial-run")
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
        start = watch.tip()
        simulator.move(leftx=0.8)
        watch.until_moved_from(start)
        simulator.unplug()
        trainee.until_still()
        watch.until(lambda state: state["phase"] == "paused")
        simulator.plug_in()
        trainee.until_menu("trial")
        trainee.choose("resume")
        watch.until(lambda state: state["phase"] == "running")
        start = watch.tip()
        simulator.move(leftx=-0.8)
        watch.until_moved_from(start)
        simulator.move(leftx=0.0)
        simulator.tap("start")
        watch.until(lambda state: state["phase"] == "paused")
        assert simulator.stop() == (0, "")
    (path,) = (tmp_path / "records").glob("*.journal")
    reading = read_journal(path)
    assert reading.header.settings["teleoperation"]["fineSpeed"] == 0.005
    assert {entry["operator"] for entry in reading.of_kind("input")} <= {"gamepad", ""}
