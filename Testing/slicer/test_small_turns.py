"""The module changes the scene in parts, between which Slicer's window answers."""

import pytest

from rastrainer.head.mesh import read_head_mesh
from rastrainer.scenario.points import LABELS
from rastrainer.slicer.scene.nodes import Role, setPoints
from Testing.slicer.host.scene_load import SceneLoad
from Testing.slicer.recorded_trial import (
    COLIN27,
    touches_on_colin,
)


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
