"""A client that plays, listens and asks cannot find the head's pose, nor can a reader of files."""

import json

import numpy as np
import pytest

from rastrainer.errors import RASTrainerError
from rastrainer.journal.journal_file import SEED_SUFFIX, read_journal
from rastrainer.protocol import Phase, Proximity
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.training.trial_start import trial_id
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, TASK, Player
from Testing.security.pose_leak import PoseFit

SEED = 5
SESSION_SEED = 3
PLACES = 6


class Eavesdropper(Player):
    """A client that keeps every state."""

    def __init__(self, port: int):
        self.states: list[dict] = []
        super().__init__(port)

    def _keep(self, message):
        if message.device == "SimState":
            self.states.append(json.loads(message.content.text))


@pytest.fixture(scope="module")
def fit() -> PoseFit:
    return PoseFit(load_scenario(asset_path("scenarios", "colin27")))


@pytest.fixture(scope="module")
def heard(fit, tmp_path_factory) -> dict:
    """The messages, answers and files that a client can read during a trial."""
    records = tmp_path_factory.mktemp("records")
    words = ("--no-views", "--speed", SPEED, "--seed", str(SESSION_SEED))
    random, seen = np.random.default_rng(1), {}
    with SimulatorProcess(records, *words) as simulator, Eavesdropper(simulator.port) as client:
        trial = client.do("StartTask", task=TASK, trainee="anna", seed=SEED)
        for around in np.linspace(0.0, 2.0 * np.pi, PLACES, endpoint=False):
            way = np.array([0.5 * np.cos(around), 0.5 * np.sin(around), 0.85])
            client.move_to(fit.center + random.uniform(140.0, 170.0) * way)
        seen["states"] = client.states
        client.move_to(fit.mark(0, SEED) + np.array([0.0, 0.0, 4.0]))
        seen["refused"] = client.send_command("Capture", {}, 60)
        state = client.wait_for("SimState", lambda state: "skin" in state.content.text, 60)
        seen["shown"] = json.loads(state.content.text)["instruction"]
        target = {"positionMm": fit.center.tolist()}
        seen["plan"] = client.send_command("PlanTarget", target, 60)
        client.do("Abort", trialId=trial["trialId"])
        trial = client.do("StartTask", task=TASK, trainee="anna")
        (path,) = records.glob(f"*_{trial['trialId']}.journal")
        seen["trial"], seen["open"] = trial["trialId"], path.read_bytes()
        seen["drawn"] = read_journal(path).header.seed
        seen["is beside"] = path.with_suffix(SEED_SUFFIX).stat().st_mode & 0o777
        client.do("Abort", trialId=trial["trialId"])
        client.do("StartTask", task=TASK, trainee="anna")
        seen["over"], seen["path"] = path.read_bytes(), path
        seen["is gone"] = not path.with_suffix(SEED_SUFFIX).exists()
    return seen


def test_the_states_of_a_trial_tell_no_distance_to_the_head(heard):
    free = {"phase": Phase.RUNNING.value, "proximity": Proximity.FREE.value}
    told = [state for state in heard["states"] if free.items() <= state.items()]
    assert told
    assert [state for state in told if state.get("clearanceMm") is not None] == []


def test_a_refused_touch_tells_how_far_off_it_is_to_nobody(heard):
    refused = heard["refused"]
    assert not refused.ok
    assert refused.data["code"] == "above the skin"
    assert refused.data["values"] == {"point": "1"}
    assert refused.error == "The tip is above the skin: lower it onto point 1."
    assert heard["shown"] == refused.error


def test_nothing_is_judged_by_the_secret_pose_before_the_touches_are_registered(heard):
    assert heard["plan"].data["code"] == "not registered"


def test_the_journal_of_an_open_trial_does_not_tell_its_seed(heard):
    assert str(heard["drawn"]).encode() not in heard["open"]
    assert heard["trial"] not in {trial_id(SESSION_SEED, number) for number in range(10)}
    assert heard["is beside"] == 0o600
    assert f'"seed":{heard["drawn"]},'.encode() in heard["over"]
    assert heard["is gone"]


def test_without_the_file_beside_it_an_open_journal_is_refused_with_what_is_missing(
    heard, tmp_path
):
    from rastrainer_simulator.core.interrupted_trial import find_interrupted

    (tmp_path / heard["path"].name).write_bytes(heard["open"])
    with pytest.raises(RASTrainerError, match=r"with the ending \.seed beside it"):
        find_interrupted(tmp_path)
