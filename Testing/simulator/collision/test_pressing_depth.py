"""How far the tool is pressed in: in the simulation's states and events, journal and replay."""

import copy

import numpy as np
import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.journal.entries import ProximityChange
from rastrainer.journal.journal_file import read_journal
from rastrainer.protocol import Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.proximity import DEEPEST, Pressing
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.replay.resimulation import replay
from rastrainer_simulator.state import NEUTRAL_STICKS, Motion, OperatorCommand, OperatorInput
from Testing.simulator.virtual.cheating_trainees import press

DT = 0.004
DOWN = OperatorInput(translation=(0.0, 0.0, -1.0), fine=True)
UP = OperatorInput(translation=(0.0, 0.0, 1.0), fine=True)


@pytest.fixture(scope="module")
def shared(setup):
    return Simulation(setup, 12)


@pytest.fixture
def simulation(shared):
    """Return a trial whose tip rests on top of the head."""
    simulation = shared
    do(simulation, CommandName.ABORT)
    do(simulation, CommandName.START_TASK, task="task-1", trainee="P01", seed=12)
    truth = simulation.truth
    move(simulation, truth.in_world(truth.target_ras) + np.array([0.0, 0.0, 130.0]))
    while simulation.state.proximity is not Proximity.CONTACT:
        speed = 50 if simulation.state.clearance > 0.002 else 5
        do(simulation, CommandName.JOG, velocityMmS=[0, 0, -speed], durationS=DT)
    return simulation


def do(simulation, command, **arguments):
    command = OperatorCommand(command, check_arguments(command, arguments))
    return simulation.step(DT, OperatorInput(commands=(command,)))


def rest(simulation, ticks):
    return [simulation.step(DT, NEUTRAL_STICKS) for _ in range(ticks)]


def move(simulation, place_mm, speed=300.0):
    do(simulation, CommandName.MOVE_TIP_TO, positionMm=list(place_mm), speedMmS=speed)
    while simulation.state.motion is not Motion.NONE:
        rest(simulation, 1)


def tip_mm(simulation):
    return MM_PER_M * simulation.state.tool_tip_to_world[:3, 3]


def test_a_move_beyond_the_skin_presses_as_deep_as_its_target_and_stops_there(simulation):
    move(simulation, tip_mm(simulation) - (0.0, 0.0, 2.0))
    assert simulation.state.clearance > -1e-4
    # The top of the head is not quite level.
    assert MM_PER_M * simulation.state.depth == pytest.approx(2.0, abs=0.1)
    depth = simulation.state.depth
    assert {result.state.depth for result in rest(simulation, 50)} == {depth}


def test_a_stick_held_down_presses_to_the_limit_and_no_farther(simulation):
    do(simulation, CommandName.JOG, velocityMmS=[0, 0, -50], durationS=0.18)
    rest(simulation, 60)
    assert 0.0 < simulation.state.depth < DEEPEST
    depths = [simulation.step(DT, DOWN).state.depth for _ in range(600)]
    assert depths == sorted(depths)
    assert depths[-1] == DEEPEST


def test_lifting_reduces_the_depth_and_the_end_of_contact_reports_the_maximum(simulation):
    for _ in range(240):
        simulation.step(DT, DOWN)
    rest(simulation, 1)
    deepest = simulation.state.depth
    assert deepest > 0.0005
    events, depths = [], []
    while simulation.state.proximity is Proximity.CONTACT:
        result = simulation.step(DT, UP)
        events.extend(result.events)
        depths.append(result.state.depth)
    assert depths == sorted(depths, reverse=True)
    assert depths[-1] == 0.0
    (left,) = (event for event in events if isinstance(event.entry, ProximityChange))
    assert left.entry.from_ is Proximity.CONTACT
    assert left.entry.depth_mm == MM_PER_M * deepest


def test_the_motion_does_not_depend_on_the_depth(shared, monkeypatch):
    def played():
        simulation = shared
        do(simulation, CommandName.ABORT)
        do(simulation, CommandName.START_TASK, task="task-1", trainee="P01", seed=12)
        truth = simulation.truth
        move(simulation, truth.in_world(truth.target_ras))
        random = np.random.default_rng(1)
        pushes = [OperatorInput(tuple(random.uniform(-1, 0.3, 3))) for _ in range(300)]
        states = [simulation.step(DT, push).state for push in pushes]
        return [(state.q, state.proximity, state.clearance) for state in states]

    measured = played()
    monkeypatch.setattr(Pressing, "move", lambda *_: None)
    assert played() == measured


@pytest.fixture(scope="module")
def pressed(setup):
    return press(setup, "trial-run", 3, depth_mm=2.0)


def test_every_touch_in_a_journal_reports_the_depth_of_the_sample_after_it(pressed):
    touches = [entry for entry in pressed.entries if entry["kind"] == "touch"]
    assert [touch["depthMm"] for touch in touches] == pytest.approx([2.0] * 15, abs=0.1)
    samples = {e["tick"]: e["depthMm"] for e in pressed.entries if e["kind"] == "sample"}
    for touch in touches:
        assert samples[touch["tick"]] == touch["depthMm"]


def test_a_forged_depth_is_detected_by_the_replay(setup, pressed, tmp_path):
    touches = [n for n, entry in enumerate(pressed.entries) if entry["kind"] == "touch"]
    begun = copy.deepcopy(pressed.entries[: touches[2] + 1])
    begun[-1]["depthMm"] += 0.5
    seed = next(entry["seed"] for entry in pressed.entries if "seed" in entry)
    journal = Journal(tmp_path / "forged.journal", seed)
    journal.write(begun, sync=False)
    journal.close()
    assert "depthMm was" in replay(read_journal(journal.path), setup).difference
