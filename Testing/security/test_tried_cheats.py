"""Cheats that were tried on the real simulator, and the outcome of each."""

from __future__ import annotations

import json
import math
import os
import signal
import time
from types import SimpleNamespace

import numpy as np
import pytest

from rastrainer.igtl.client import Client
from rastrainer.igtl.message import Transform
from rastrainer.journal.journal_file import read_journal
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import FREE, PROTOCOL_VERSION, DeviceName
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study_messages import StudyStep
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer_simulator.ops.instructor_pin import InstructorPin
from Testing.end_to_end.finished_trials import COLIN
from Testing.end_to_end.registered_trial import registration_of
from Testing.end_to_end.simulator_process import SimulatorProcess, ViewedSimulator
from Testing.end_to_end.stream_trainee import WatchingView
from Testing.end_to_end.test_trial_over_openigtlink import TASK, Player, play
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.net.views.served import ViewClient, request

pytestmark = pytest.mark.skipif(os.name == "nt", reason="a POSIX signal stops the process")

PIN = "271828"
STOPS = 11
HELD_UP_S = 4.0
PAUSED_S = 4
CAUGHT_UP = 0.02
"""Share of its time that a simulator may catch up after it was held up."""
DETAILS = {"isAccurate": True, "isUnbiased": True, "isSafe": True, "scoreVersion": SCORE_VERSION}
SCORE = {"score": 81.0, "details": DETAILS}
BEST = {**SCORE, "score": 100.0}
POSES = {
    DeviceName.TOOL_TIP_TO_WORLD,
    DeviceName.INSTRUMENT_TIP_TO_WORLD,
    *DeviceName.LINK_TO_WORLD,
}


class GhostWatch(WatchingView):
    """Records every ghost that it is shown: one may have ended if a busy machine looks late."""

    def __init__(self, client):
        self.ghosts = []
        super().__init__(client)

    @property
    def state(self):
        return self._state

    @state.setter
    def state(self, state):
        self._state = state
        if state is not None and state["ghost"] is not None:
            self.ghosts.append(state["ghost"])


def has_moved(ghosts):
    """Return whether the tip of a ghost was elsewhere than at first."""
    tips = [ghost["tool"][:3] for ghost in ghosts]
    return any(math.dist(tip, tips[0]) > 0.02 for tip in tips)


class SlowPlayer(Player):
    """A client that gains time to think at its first touch: by pauses, and by stopping the process.

    A long pause afterwards is to make the simulator look as fast as the clock.
    """

    def __init__(self, simulator: SimulatorProcess):
        self._pid, self._is_slow = simulator.pid, False
        super().__init__(simulator.port)

    def do(self, name: str, **arguments) -> dict:
        if name == "Capture" and not self._is_slow:
            self._is_slow = True
            for _ in range(STOPS):
                super().do("Pause")
                super().do("Resume")
            os.kill(self._pid, signal.SIGSTOP)
            time.sleep(HELD_UP_S)
            os.kill(self._pid, signal.SIGCONT)
            super().do("Pause")
            self.wait_for_heartbeats(PAUSED_S)
            super().do("Resume")
        return super().do(name, **arguments)


class Board(ViewClient):
    """A teacher's board, which knows the PIN of the seat."""

    def __init__(self, thread, simulator: ViewedSimulator):
        pairing = {"code": simulator.code, "role": "board"}
        _status, _headers, body = request(simulator.url, "/pair", "POST", data=json.dumps(pairing))
        self._url, self._key = simulator.url, json.loads(body)["key"]
        super().__init__(thread, simulator.url, self._key)
        self.join(kind="board")

    def order(self, name: str) -> int:
        """Give an order; return the status of the answer."""
        values = {"pin": PIN, "order": name, "text": "Go on."}
        headers = {"Authorization": f"Bearer {self._key}"}
        answer = request(self._url, "/instructor", "POST", headers=headers, data=json.dumps(values))
        return answer[0]


def hello(client: Client, **others) -> Client:
    """Greet the simulator as a client that scores."""
    greeting = {"protocolVersion": PROTOCOL_VERSION, "client": "bystander", **others}
    assert client.send_command("Hello", greeting, 60).ok
    return client


def scores_of(records, trial: str) -> list[float]:
    (path,) = records.glob(f"*_{trial}.journal")
    return [entry["arguments"]["score"] for entry in read_journal(path).of_kind("scored")]


@pytest.fixture(scope="module")
def place(loop_thread, tmp_path_factory):
    """A simulator at which a client has played and scored a trial in slow motion."""
    records = tmp_path_factory.mktemp("records")
    config = records.with_name(records.name + "-config")
    config.mkdir()
    (config / "preferences.json").write_text('{"order": "any", "ghost": "own best"}')
    InstructorPin(config).set(PIN)
    scenario, heard = load_scenario(COLIN), []
    with (
        ViewedSimulator(records) as simulator,
        ViewClient(loop_thread, simulator.url, simulator.key) as client,
        Board(loop_thread, simulator) as board,
        SlowPlayer(simulator) as player,
        Client(port=simulator.port, on_message=heard.append) as listener,
    ):
        view = GhostWatch(client)
        trial = play(player, scenario)["StartTask"]["trialId"]
        record = record_from_json(TrialRecord, player.next_offer())
        player.do("SubmitRegistration", **registration_of(player, trial, scenario))
        player.do("TrialScored", trialId=trial, **SCORE)
        yield SimpleNamespace(
            records=records,
            simulator=simulator,
            view=view,
            board=board,
            player=player,
            listener=listener,
            heard=heard,
            trial=trial,
            record=record,
        )


def test_slow_motion_by_pauses_or_by_stopping_the_process_is_in_the_record(place):
    played, time_s = place.record.played, place.record.completion_time_s
    assert played.pauses == STOPS + 1
    assert played.pace <= time_s / (time_s + HELD_UP_S) + CAUGHT_UP
    objections = "; ".join(played.objections("desktop", ()))
    assert f"it was paused {STOPS + 1} times" in objections
    assert "times as fast as the clock" in objections


def test_neither_a_ghost_nor_a_replay_tells_a_client_where_the_head_is(place):
    view, listener, heard = place.view, place.listener, place.heard
    wait_until(lambda: view.menu_name == "result", "the result")
    before = len(heard)
    assert place.board.order("replay") == 200
    wait_until(lambda: view.menu_name is None, "the replay")
    wait_until(lambda: view.state["phase"] in ("running", "complete"), "the trial")
    view.ghosts.clear()
    trial = place.player.do("StartTask", task=TASK, trainee="anna")["trialId"]
    wait_until(lambda: has_moved(view.ghosts), "the ghost on its way")
    assert place.board.order("replay") == 409
    of_open = listener.send_command("GetTrial", {"trialId": trial}, 60).data
    assert not {"headToWorld", "seed", "ghost"} & of_open.keys()
    with Client(port=place.simulator.port) as other:
        assert not hello(other).send_command("GetJournal", {"trialId": trial}, 60).ok
    assert place.player.do("Abort", trialId=trial)
    told = heard[before:]
    assert not any("ghost" in str(message.content) for message in told)
    assert not any(getattr(message.content, "points", ()) for message in told)
    poses: dict[str, list[np.ndarray]] = {}
    for message in told:
        if type(message.content) is Transform:
            poses.setdefault(message.device, []).append(np.array(message.content.matrix))
    assert poses.keys() <= POSES
    # The screen moves, not the arm, which is at rest.
    assert all(np.allclose(pose, each[0], atol=1e-3) for each in poses.values() for pose in each)


def test_a_board_starts_no_step_of_a_study(place):
    step = StudyStep("anna", "trial", 3, 19, TASK, "desktop")
    place.player.do("StudyStep", **record_to_json(step))
    journals = set(place.records.glob("*.journal"))
    statuses = {name: place.board.order(name) for name in ("pause", "say", "replay", "start")}
    assert statuses.pop("start") == 400
    assert set(statuses.values()) <= {200, 409}
    place.board.send({"type": "item", "name": "start"})
    assert place.board.closing()[0] == 1008
    # The simulator has taken another command since, and nothing was started.
    assert place.player.do("GetTrial", trialId=place.trial)["phase"] == "scored"
    assert set(place.records.glob("*.journal")) == journals
    place.player.do("StudyStep", **record_to_json(StudyStep("anna", FREE)))


def test_a_score_is_replaced_by_no_client_but_one_that_scores_and_the_journal_keeps_both(place):
    """The latest is shown at the simulator; a study keeps what its own Slicer has computed."""
    best, own = {"trialId": place.trial, **BEST}, SCORE["score"]
    with Client(port=place.simulator.port) as other:
        for client in (place.listener, hello(other, scores=False)):
            refused = client.send_command("TrialScored", best, 60)
            assert "is for clients that register and score" in refused.error
        assert scores_of(place.records, place.trial) == [own]
        assert hello(other).send_command("TrialScored", best, 60).ok
    assert scores_of(place.records, place.trial) == [own, BEST["score"]]
