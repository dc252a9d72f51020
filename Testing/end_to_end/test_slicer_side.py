"""Slicer's side against the simulator's process: live points, and a crash in between."""

from __future__ import annotations

import threading
from itertools import groupby

import numpy as np
import pytest
from slicer.util import arrayFromMarkupsControlPoints

from rastrainer import transforms
from rastrainer.igtl.client import Client
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
from rastrainer_simulator.virtual.scripted_trial import send_hello
from Testing.end_to_end.onto_skin import lower_onto_skin
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.end_to_end.window_process import wait_until
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


def start_playing(port, counts):
    """Play a trial in a separate thread; return a function that returns whether it is over.

    Each touch is waited for in `counts`, the numbers of points that Slicer's side has seen.
    """
    scenario = load_scenario(COLIN)
    head_to_world = scenario.perturbed_head_to_world(SEED)
    fiducials = transforms.apply(head_to_world, scenario.task("task-1").fiducials)
    center = transforms.apply(head_to_world, scenario.target.position_ras)

    def play():
        with Client(port=port) as client:
            send_hello(client, "player")
            do(client, "StartTask", task="task-1", trainee="T-042", seed=SEED)
            for number, fiducial in enumerate(fiducials, start=1):
                above = fiducial + 40.0 * (fiducial - center) / np.linalg.norm(fiducial - center)
                move_to(client, above)
                lower_onto_skin(client, fiducial, center)
                do(client, "Capture")
                wait_until(lambda n=number: n in counts, f"touch {number}")
                move_to(client, above)
            do(client, "Register")

    thread = threading.Thread(target=play, daemon=True)
    thread.start()
    return lambda: not thread.is_alive()


def do(client, name, **arguments):
    reply = client.send_command(name, arguments, timeout=60)
    assert reply.ok, f"{name}: {reply.error}"


def move_to(client, place):
    def is_there(tip):
        return np.linalg.norm(np.array(tip.content.matrix)[:3, 3] - place) < 1.5

    do(client, "MoveTipTo", positionMm=place.tolist(), speedMmS=400)
    client.wait_for("ToolTipToWorld", is_there, 60)


@pytest.fixture(scope="module")
def slicer_side(tmp_path_factory):
    """What Slicer's side has seen of a trial whose simulator crashed before it was stored."""
    folder = tmp_path_factory.mktemp("lab")
    side = SlicerSide(folder / "study.db")
    port = ("--port", str(free_port()))
    with SimulatorProcess(folder / "records", "--no-views", "--speed", "20", *port) as simulator:
        side.link.connectTo(port=simulator.port)
        side.run_until(side.is_in(LinkState.CONNECTED))
        side.run_until(start_playing(simulator.port, side.counts))
        simulator.kill()
    side.run_until(side.is_in(LinkState.ABSENT))
    side.live_counts, side.live_points = list(side.counts), side.points
    side.open_logic()
    with SimulatorProcess(folder / "records", "--no-views", *port):
        side.run_until(lambda: side.scored)
        side.run_until(side.is_in(LinkState.CONNECTED))
    side.link.disconnect()
    side.logic.close()
    return side


def test_points_appear_as_they_are_touched(slicer_side):
    counts = slicer_side.live_counts
    assert counts == sorted(set(counts))
    assert {*range(1, 16)} <= {*counts} <= {*range(16)}


def test_the_crash_is_reported_and_the_link_recovers(slicer_side):
    reported = (LinkState.CONNECTED, LinkState.ABSENT, LinkState.OFF)
    # How often it looks for the simulator meanwhile depends on how long that takes to start.
    seen = [state for state, _again in groupby(s for s in slicer_side.states if s in reported)]
    assert seen[-4:] == [
        LinkState.CONNECTED,
        LinkState.ABSENT,
        LinkState.CONNECTED,
        LinkState.OFF,
    ]


def test_the_trial_is_recovered_from_the_journal_and_stored_once(slicer_side):
    with Study.open(slicer_side.study) as study:
        (trial,) = study.history("T-042")
    assert len(slicer_side.scored) == 1
    assert trial.record.task == "task-1"
    # Points travel as 32-bit numbers, the record as text: the scene saw the recorded points.
    np.testing.assert_allclose(slicer_side.live_points, trial.record.positions_mm, atol=1e-3)


def test_the_truth_that_is_stored_follows_from_the_seed(slicer_side):
    with Study.open(slicer_side.study) as study:
        (trial,) = study.history("T-042")
    scenario = load_scenario(COLIN)
    head_to_world = scenario.perturbed_head_to_world(SEED)
    np.testing.assert_allclose(trial.truth.matrix, head_to_world, atol=1e-9)
    found = np.reshape(trial.registrations["rigid"].matrix, (4, 4)) @ head_to_world
    target = scenario.target.position_ras
    error = np.linalg.norm(transforms.apply(found, target) - target)
    assert trial.true_tre_mm == pytest.approx(error, abs=1e-6)
