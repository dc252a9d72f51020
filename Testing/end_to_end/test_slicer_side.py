"""Slicer's side against the simulator's process: live points, and a crash in between."""

from __future__ import annotations

from itertools import groupby

import numpy as np
import pytest
from slicer.util import arrayFromMarkupsControlPoints

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.scenario_files import ScenarioCache
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.sections.trial_services import TrialServices
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.link.link_status import LinkState
from rastrainer.study.database.study import Study
from rastrainer_headless.connector import headlessKit
from rastrainer_headless.scene import HeadlessScene
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.module.player import Player
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.free_port import free_port
from Testing.slicer.simulator_double import run_logic_until

COLIN = asset_path("scenarios", "colin27")
SEED = 11


class SlicerSide:
    """Scene, link and study, driven as an application's timer would."""

    def __init__(self, study):
        self.study = study
        self.scene = HeadlessScene().scene
        self.link = Link(self.scene, headlessKit)
        self.states, self.counts, self.points, self.scored = [], [], None, []
        self.link.statusChanged.connect(lambda status: self.states.append(status.state))
        self.link.pointsChanged.connect(self.see_points)
        self.logic = None
        self.work = BackgroundWork()

    def see_points(self, node):
        self.counts.append(node.GetNumberOfControlPoints())
        self.points = arrayFromMarkupsControlPoints(node)

    def open_logic(self):
        find = ScenarioCache(COLIN.parent).find
        services = TrialServices(
            self.scene, self.link, find, lambda: Study.open(self.study), self.work
        )
        self.logic = TrialLogic(services)
        self.logic.trialScored.connect(self.scored.append)

    def run_until(self, condition):
        run_logic_until(self.link, self.work, condition)

    def is_in(self, state):
        return lambda: self.link.status.state is state


def test_a_crash_loses_no_touch_and_the_trial_is_stored_once_with_its_truth(tmp_path):
    side = SlicerSide(tmp_path / "study.db")
    port = ("--port", str(free_port()))
    with SimulatorProcess(tmp_path / "records", "--no-views", "--speed", "20", *port) as simulator:
        side.link.connectTo(port=simulator.port)
        side.run_until(side.is_in(LinkState.CONNECTED))
        task, started = {"task": "task-1", "trainee": "T-042", "seed": SEED}, []
        side.link.send(CommandName.START_TASK, task, started.append)
        side.run_until(lambda: started)
        player = Player(simulator.port, tmp_path / "records")
        for number in range(1, 16):
            player.touch(number, number)
            side.run_until(lambda n=number: player.is_done and n in side.counts)
        player.register()
        side.run_until(lambda: player.is_done)
        simulator.kill()
    side.run_until(side.is_in(LinkState.ABSENT))
    assert side.counts == sorted(set(side.counts)), "points appear as they are touched"
    live_points = side.points
    side.open_logic()
    with SimulatorProcess(tmp_path / "records", "--no-views", *port):
        side.run_until(lambda: side.scored)
        side.run_until(side.is_in(LinkState.CONNECTED))
    side.link.disconnect()
    side.logic.close()
    reported = (LinkState.CONNECTED, LinkState.ABSENT, LinkState.OFF)
    # How often it looks for the simulator meanwhile depends on how long that takes to start.
    seen = [state for state, _again in groupby(s for s in side.states if s in reported)]
    assert seen[-3:] == [LinkState.ABSENT, LinkState.CONNECTED, LinkState.OFF]
    with Study.open(side.study) as study:
        (trial,) = study.history("T-042")
    assert len(side.scored) == 1
    assert trial.record.task == "task-1"
    # Points travel as 32-bit numbers, the record as text: the scene saw the recorded points.
    np.testing.assert_allclose(live_points, trial.record.positions_mm, atol=1e-3)
    scenario = load_scenario(COLIN)
    head_to_world = scenario.perturbed_head_to_world(SEED)
    np.testing.assert_allclose(trial.truth.matrix, head_to_world, atol=1e-9)
    found = np.reshape(trial.registrations["rigid"].matrix, (4, 4)) @ head_to_world
    target = scenario.target.position_ras
    error = np.linalg.norm(transforms.apply(found, target) - target)
    assert trial.true_tre_mm == pytest.approx(error, abs=1e-6)
