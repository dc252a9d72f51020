"""Any model or volume of the scene can be the head that is shown."""

import threading
from types import SimpleNamespace

import numpy as np
import pytest
import slicer

from rastrainer.errors import InputError
from rastrainer.sections.scenario_logic import ScenarioLogic
from rastrainer.slicer.program.child_process import runHere
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.robot import missingLinks
from rastrainer.slicer.scene.robot_description import READ_LINKS
from rastrainer.slicer.scene.trial_scene import isApplied
from rastrainer_simulator.assets import asset_path
from Testing.domain.scenario.made_up_scenario import ball_head
from Testing.slicer.work_at_once import in_turns


@pytest.fixture
def runs():
    """The functions that were run, each with its thread."""
    return []


@pytest.fixture
def logic(scene, scenario, work, runs):
    def run(function, *arguments, **named):
        runs.append((function, threading.get_ident()))
        return runHere(function, *arguments, **named)

    return ScenarioLogic(scene, cache(scenario), asset_path("robots", "iiwa7"), run, work)


def cache(scenario):
    return SimpleNamespace(find=lambda _name: scenario)


def volume(scene, values):
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "MRI")
    slicer.util.updateVolumeFromArray(node, values)
    node.SetSpacing(3.0, 3.0, 3.0)
    return node


def test_the_robot_is_read_once_and_elsewhere_and_stays_hidden_or_cleared(scene, logic, work, runs):
    shown = []
    logic.robotShown.connect(lambda: shown.append(missingLinks(scene)))
    logic.setRobotShown(True)
    assert logic.isRobotShown
    in_turns(work)
    assert shown == [[]]
    ((function, thread),) = runs
    assert function == READ_LINKS
    assert thread != threading.get_ident()
    logic.setRobotShown(False)
    assert not logic.isRobotShown
    scene.Clear(0)
    logic.forgetScene()
    logic.setRobotShown(True)
    in_turns(work)
    assert missingLinks(scene) == []
    assert len(runs) == 1

    def clear():
        scene.Clear(0)
        logic.forgetScene()

    clear()
    # It can also be hidden while it loads.
    for end in (lambda: logic.setRobotShown(False), clear):
        logic.setRobotShown(True)
        in_turns(work, end)
        assert not logic.isRobotShown
        assert len(missingLinks(scene)) >= 7


class Search:
    """A search for the head of a volume, which lasts until `end` is set."""

    def __init__(self, logic):
        self.end = threading.Event()
        logic.run = self

    def __call__(self, *_arguments):
        assert self.end.wait(60.0)
        return SimpleNamespace(labels=None), ball_head(60.0), ["A warning."]


def test_a_scenario_is_shown_and_a_head_found_meanwhile_takes_its_place(scene, logic, work):
    with pytest.raises(InputError, match="no such task"):
        logic.show("ball", "task-9")
    assert not work.isBusy
    formers, search = [], Search(logic)

    def show(_step, _share):
        if not search.end.is_set():
            logic.show("ball", "task-1")
            in_turns(work)
            formers.append(Role.HEAD_MODEL.find(scene))
            search.end.set()

    model, warnings = logic.useHead(volume(scene, np.ones((20, 20, 20))), show)
    assert isApplied(Role.WORLD_TO_HEAD.find(scene))
    assert Role.HEAD_MODEL.all(scene) == [model]
    assert (model.GetName(), warnings) == ("Head of MRI", ["A warning."])
    assert [bool(former.GetDisplayVisibility()) for former in formers] == [False]
    # The next scenario's head does not overwrite it.
    logic.show("ball", "task-1")
    in_turns(work)
    assert Role.HEAD_MODEL.find(scene) is not model
    assert not model.GetDisplayVisibility()
    np.testing.assert_allclose(model.GetPolyData().GetBounds(), [-60.0, 60.0] * 3, atol=1.0)


def test_a_canceled_search_or_an_empty_volume_leaves_the_head(scene, logic, work):
    def cancel(_step, _share):
        raise InputError("Canceled")

    logic.show("ball", "task-1")
    in_turns(work)
    shown = Role.HEAD_MODEL.find(scene)
    with pytest.raises(InputError, match="holds no image"):
        logic.useHead(scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "Empty"))
    search = Search(logic)
    with pytest.raises(InputError, match="Canceled"):
        logic.useHead(volume(scene, np.ones((20, 20, 20))), cancel)
    search.end.set()
    assert Role.HEAD_MODEL.all(scene) == [shown]
    assert shown.GetDisplayVisibility()
