"""Nothing of a closed scene is mistaken for part of the next one, whose nodes have the same IDs."""

import numpy as np
import pytest
import slicer

from rastrainer.errors import InputError
from rastrainer.scenario.points import LABELS
from rastrainer.sections import scenario_logic
from rastrainer.sections.new_scenario_logic import NewScenarioOptions
from rastrainer.slicer.scene.nodes import Role, setPoints
from Testing.slicer.recorded_trial import (
    put_touches,
    touches_on_colin,
)

FIDUCIALS = "vtkMRMLMarkupsFiducialNode"


@pytest.fixture
def host(fresh_module):
    return fresh_module


@pytest.fixture
def session(host):
    return host.widget.logic.session


def add_list(scene, name, points):
    node = scene.AddNewNodeByClass(FIDUCIALS, name)
    setPoints(node, LABELS[: len(points)], points)
    return node


def test_a_chosen_list_is_not_mistaken_for_the_next_one_with_its_id(host, session):
    logic, fixed = session.registration, np.random.default_rng(1).normal(0, 50, (15, 3))
    own = [add_list(host.scene, name, fixed) for name in ("mine", "also mine")]
    logic.chooseLists(*own, None)
    logic.process()
    host.scene.Clear(0)
    other = [add_list(host.scene, name, fixed) for name in ("theirs", "also theirs")]
    assert [node.GetID() for node in other] == [node.GetID() for node in own]
    assert logic.lists()[0] is None
    assert (logic.comparison, bool(logic.problem)) == (None, True)


def test_a_plan_placed_at_once_in_the_next_scene_is_not_mapped_by_the_old_registration(
    host, session
):
    session.scenario.show("colin27", "task-1")
    host.finish_work()
    put_touches(host, touches_on_colin())
    host.scene.Clear(0)
    target = add_list(host.scene, "target", np.zeros((1, 3)))
    with pytest.raises(InputError, match="no registration to map the plan with"):
        session.plan.read(target)


def test_a_head_found_in_a_closed_scenes_volume_is_not_used_for_the_next_scenes(
    host, session, monkeypatch
):
    volume = host.scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "former")
    slicer.util.updateVolumeFromArray(volume, np.zeros((20, 20, 20), np.int16))

    monkeypatch.setattr(scenario_logic, "inBackground", lambda *_arguments: host.scene.Clear(0))
    with pytest.raises(InputError, match="was removed before its head was found"):
        session.scenarioMaker.preview(NewScenarioOptions(volume), lambda _step, _share: None)
    assert Role.HEAD_SEGMENT.find(host.scene) is None


def test_nothing_is_added_to_a_scene_while_it_is_being_loaded(host, session):  # noqa: ARG001
    count = host.scene.GetNumberOfNodes()
    host.scene.StartState(host.scene.BatchProcessState)
    host.widget.onTimeout()
    assert host.scene.GetNumberOfNodes() == count
    host.scene.EndState(host.scene.BatchProcessState)
