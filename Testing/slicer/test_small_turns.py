"""The module changes the scene in parts, between which Slicer's window answers."""

import uuid
from pathlib import Path

import pytest

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.points import LABELS
from rastrainer.slicer.scene.nodes import Role, setPoints
from Testing.slicer.host.scene_load import SceneLoad
from Testing.slicer.recorded_trial import (
    COLIN27,
    store_trial_on_colin,
    touches_on_colin,
    write_recorded_trial,
)
from Testing.slicer.simulator_double import SimulatorDouble

TRIAL = str(uuid.UUID(int=1))


@pytest.fixture
def opened(fresh_module):
    fresh_module.unfold("robotCheckBox")
    return fresh_module


def shown(host, *actions):
    """Return what the scene was handed until all that the actions have begun was shown."""
    with SceneLoad(host.scene) as load:
        for action in actions:
            action()
            host.idle_for(0.3)
            host.finish_work()
    return load


def triangles(path):
    return len(read_head_mesh(path).triangles)


def test_a_scenario_comes_one_surface_one_view_and_few_nodes_at_a_time(opened):
    load = shown(opened, lambda: opened.press("showScenarioButton"))
    largest = max(triangles(COLIN27.head), triangles(COLIN27.skull.file))
    assert load.most.cells == largest
    assert load.total.cells == triangles(COLIN27.head) + triangles(COLIN27.skull.file)
    assert load.most.views == 1
    assert load.total.views > 1
    # A list of points, its display, and the planned pose.
    assert load.most.nodes <= 3
    assert load.total.nodes >= 12


def test_the_nodes_of_a_replay_come_a_few_in_each_turn(opened, make_record):
    session = opened.widget.logic.session
    record = make_record(TRIAL, scenario="colin27")
    store_trial_on_colin(opened, record, 1)
    write_recorded_trial(Path.home() / "RASTrainer" / "trials", record["trialId"])
    with SceneLoad(opened.scene) as load:
        session.replay.show(
            session.trainees.study.trial(record["trialId"]), lambda _step, _share: load.end_turn()
        )
    # The tool's model comes with its display and colors.
    assert load.most.nodes <= 4
    assert load.total.nodes >= 20


def test_the_robot_comes_one_link_at_a_time_and_is_told_of_once(opened):
    load = shown(opened, lambda: opened.check("robotCheckBox"))
    cells = [Role.LINKS[n].find(opened.scene).GetPolyData().GetNumberOfCells() for n in range(8)]
    assert load.most.cells == max(cells)
    assert load.total.cells == sum(cells)
    # A model, its display and its pose, which are set before they are added to the scene.
    assert load.most.nodes <= 3
    assert load.most.events < 20


def test_touches_are_shown_in_parts_and_each_once(opened):
    opened.press("showScenarioButton")
    opened.finish_work()
    touched, points = touches_on_colin(), Role.CAPTURED_POINTS.make(opened.scene)
    load = shown(
        opened,
        lambda: setPoints(points, LABELS[:14], touched[:14]),
        lambda: setPoints(points, LABELS, touched),
    )
    assert opened.find("residualsTable").rowCount == 15
    # The arrows of both; the head is not handed over again.
    assert 0 < load.most.cells < load.total.cells < triangles(COLIN27.head)
    assert load.most.events < 50


def test_connecting_makes_one_node_at_a_time(opened):
    def connect():
        opened.press("connectButton")
        name = "Link7ToWorld"
        opened.wait_until(lambda: opened.scene.GetFirstNodeByName(name), "all nodes are there")

    with SimulatorDouble() as simulator:
        opened.type("portSpinBox", str(simulator.port))
        load = shown(opened, connect)
    # The list of touches and its display come with the module's node and the node of the state.
    assert load.most.nodes <= 4
    assert load.total.nodes > 12
