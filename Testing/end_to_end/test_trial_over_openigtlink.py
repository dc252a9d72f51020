"""A whole trial over OpenIGTLink, against the simulator as its own process."""

from __future__ import annotations

import json
import time

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.igtl.client import Client
from rastrainer.json_records import record_from_json
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.onto_skin import carry_to, lower_onto_skin
from Testing.end_to_end.registered_trial import registration_of
from Testing.end_to_end.simulator_process import SimulatorProcess

TASK = "task-1"
SEED = 5
SPEED = "8"
ABOVE_MM = 40.0
NEAR_MM = 1.5


class Player(Client):
    """A client that says hello, and collects the finished trials that it is offered."""

    def __init__(self, port: int):
        self.offers: list[dict] = []
        super().__init__(port=port, on_message=self._keep)
        self.do("Hello", protocolVersion=PROTOCOL_VERSION, client="player")

    def _keep(self, message):
        if message.device == "command" and message.content.name == "TrialCompleted":
            self.offers.append(json.loads(message.content.body))

    def do(self, name: str, **arguments) -> dict:
        reply = self.send_command(name, arguments, timeout=60)
        assert reply.ok, f"{name}: {reply.error}"
        return dict(reply.data)

    def move_to(self, position: np.ndarray) -> None:
        carry_to(self, position)

    def next_offer(self) -> dict:
        count, give_up = len(self.offers), time.monotonic() + 60.0
        while len(self.offers) == count:
            assert time.monotonic() < give_up, "no trial was offered"
            self.wait_for_heartbeats(1)
        return self.offers[-1]

    def wait_for_heartbeats(self, count: int) -> None:
        """Wait for a number of them, one a second."""
        for _ in range(count):
            last = self.latest.get("SimServer")
            self.wait_for("SimServer", lambda beat, last=last: beat is not last, 60)


def play(player: Player, scenario: Scenario, **start: str) -> dict:
    """Play one trial up to its registration; return what the commands answered.

    `start` goes to StartTask besides task, trainee and seed.
    """
    task, head_to_world = scenario.task(TASK), scenario.perturbed_head_to_world(SEED)
    head = read_head_mesh(scenario.head)
    normals = outward_normals(head, task.fiducials)
    fiducials = transforms.apply(head_to_world, task.fiducials)
    above = fiducials + ABOVE_MM * normals @ head_to_world[:3, :3].T
    answers = {"StartTask": player.do("StartTask", task=TASK, trainee="anna", seed=SEED, **start)}
    for fiducial, place_above in zip(fiducials, above, strict=True):
        player.move_to(place_above)
        lower_onto_skin(player, fiducial, 2 * fiducial - place_above)
        player.do("Capture")
        player.move_to(place_above)
    points = player.wait_for("CapturedPoints", lambda m: len(m.content.points) == 15, 60)
    answers["points"] = points.content.points
    answers["Register"] = player.do("Register")
    return answers


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return load_scenario(asset_path("scenarios", "colin27"))


@pytest.fixture(scope="module")
def trial(scenario, tmp_path_factory) -> dict:
    """Clients' observations of a trial whose simulator crashes twice before it is acknowledged."""
    records = tmp_path_factory.mktemp("records")
    with (
        SimulatorProcess(records, "--no-views", "--speed", SPEED) as simulator,
        Player(simulator.port) as player,
    ):
        seen = play(player, scenario)
        seen["offers"] = [player.next_offer(), player.next_offer()]
        trial_id = seen["StartTask"]["trialId"]
        seen["before"] = player.do("GetTrial", trialId=trial_id)
        found = registration_of(player, trial_id, scenario)
        seen["truth"] = player.do("SubmitRegistration", **found)
        player.do("TrialScored", trialId=trial_id, score=80)
        player.wait_for("SimState", lambda state: '"scored"' in state.content.text, 60)
        simulator.kill()
    with SimulatorProcess(records, "--no-views") as simulator, Player(simulator.port) as player:
        seen["offer after a crash"] = player.next_offer()
        player.do("AcknowledgeTrial", trialId=trial_id)
        simulator.kill()
    with SimulatorProcess(records, "--no-views") as simulator, Player(simulator.port) as player:
        seen["after"] = player.do("GetTrial", trialId=trial_id)
        player.wait_for_heartbeats(3)
        seen["offers at last"] = player.offers
        seen["journals"] = [path.name for path in records.glob("*.journal")]
        seen["exit"] = simulator.stop()
    return seen


def test_a_trial_is_offered_until_it_is_acknowledged_through_crashes_and_exits_cleanly(
    trial, scenario
):
    fiducials = transforms.apply(
        scenario.perturbed_head_to_world(SEED), scenario.task(TASK).fiducials
    )
    assert [point.label for point in trial["points"]] == [str(i) for i in range(1, 16)]
    touched = np.array([point.position for point in trial["points"]])
    assert np.linalg.norm(touched - fiducials, axis=1).max() < 2 * NEAR_MM
    first, again = trial["offers"]
    record = record_from_json(TrialRecord, first)
    assert record.trial_id == trial["StartTask"]["trialId"]
    assert (record.trainee, record.task) == ("anna", TASK)
    np.testing.assert_allclose(record.positions_mm, touched, atol=1e-4)
    assert first == again == trial["offer after a crash"]
    assert trial["offers at last"] == []
    assert trial["after"]["acknowledged"]
    assert len(trial["journals"]) == 1
    assert trial["exit"] == (0, "")


def test_the_head_pose_stays_secret_until_a_registration_is_submitted(trial, scenario):
    assert "headToWorld" not in json.dumps([trial["Register"], trial["offers"], trial["before"]])
    revealed = np.array(trial["truth"]["headToWorld"]).reshape(4, 4)
    np.testing.assert_allclose(revealed, scenario.perturbed_head_to_world(SEED), atol=1e-9)
    assert trial["truth"]["trueTreMm"] < 2 * NEAR_MM
    assert trial["after"]["headToWorld"] == trial["truth"]["headToWorld"]
