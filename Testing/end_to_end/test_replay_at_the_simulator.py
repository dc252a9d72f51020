"""A trial that was played and scored over OpenIGTLink, shown again by the simulator's process.

First alone, then as a ghost next to the arm in the next trial.
"""

from __future__ import annotations

import math

import pytest

from rastrainer.igtl.client import Client
from rastrainer.scenario.scenario import load_scenario
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.virtual.scripted_trainee import Skill
from rastrainer_simulator.virtual.scripted_trial import play_trial, send_hello
from Testing.end_to_end.registered_trial import registration_of
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.end_to_end.stream_trainee import WatchingView
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.net.views.served import ViewClient

BRISK = Skill(speed_mm_s=300.0, gain_per_s=6.0, reaction_s=0.1, dwell_s=0.04, slip_at=None)
SPEED = ("--speed", "4")
DETAILS = {"isAccurate": True, "isUnbiased": True, "isSafe": True, "scoreVersion": SCORE_VERSION}
SCORE = {"score": 81.0, "details": DETAILS}


@pytest.fixture
def simulator(tmp_path):
    config = tmp_path / "records-config"
    config.mkdir()
    (config / "preferences.json").write_text('{"order": "any", "ghost": "own best"}')
    with ViewedSimulator(tmp_path / "records", *SPEED) as simulator:
        yield simulator


@pytest.fixture
def slicer(simulator):
    """A client that has played and scored a trial."""
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    with Client(port=simulator.port) as slicer:
        send_hello(slicer, "Slicer")
        trial = play_trial(slicer, scenario, "task-1", "P07", 5, BRISK)
        found = registration_of(slicer, trial.trial_id, scenario)
        scored = {"trialId": trial.trial_id, **SCORE}
        assert slicer.send_command("SubmitRegistration", found, timeout=60).ok
        assert slicer.send_command("TrialScored", scored, timeout=60).ok
        yield slicer


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


@pytest.fixture
def views(loop_thread, simulator):
    """Two pages that have joined: what each sends, and what each receives."""
    with (
        ViewClient(loop_thread, simulator.url, simulator.key) as one,
        ViewClient(loop_thread, simulator.url, simulator.key) as other,
    ):
        yield (one, GhostWatch(one)), (other, GhostWatch(other))


def shown(view):
    """Return the name of the menu; None if none is open."""
    menu = view.screen.menu
    return menu and menu.name


def has_moved(ghosts):
    """Return whether the tip of a ghost was elsewhere than at first."""
    tips = [ghost["tool"][:3] for ghost in ghosts]
    return any(math.dist(tip, tips[0]) > 0.02 for tip in tips)


def test_all_views_see_the_trial_again_then_the_arm_and_then_its_ghost(tmp_path, views, slicer):
    (journal,) = (tmp_path / "records").glob("*.journal")
    before = journal.read_bytes()
    (client, first), (_, second) = views
    wait_until(lambda: shown(first) == "result", "the result")
    client.send({"type": "item", "name": "worst"})
    for view in (first, second):
        wait_until(lambda view=view: shown(view) is None, "the replay")
        wait_until(
            lambda view=view: "the worst touch, at half speed" in view.screen.instruction.text,
            "the worst touch",
        )
        wait_until(lambda view=view: view.state["phase"] in ("running", "complete"), "the trial")
    client.send({"type": "key", "code": "Escape", "isDown": True, "text": ""})
    for view in (first, second):
        wait_until(lambda view=view: shown(view) == "result", "the result again")
        wait_until(lambda view=view: view.state["phase"] == "scored", "the arm")
    task = {"task": "task-1", "trainee": "P07", "mode": "desktop"}
    assert slicer.send_command("StartTask", task, timeout=60).ok
    for view in (first, second):
        wait_until(lambda view=view: has_moved(view.ghosts), "the ghost on its way")
        assert view.ghosts[0].keys() == {"link_7", "tool"}
    assert slicer.send_command("Abort", timeout=60).ok
    wait_until(lambda: first.state["ghost"] is None, "its end")
    assert journal.read_bytes() == before
