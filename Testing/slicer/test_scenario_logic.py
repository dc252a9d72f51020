"""Any model or volume of the scene can be the head that is shown."""

import threading

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
from Testing.slicer.work_at_once import in_turns


class Cache:
    def __init__(self, scenario):
        self._scenario = scenario

    def find(self, _name):
        return self._scenario


@pytest.fixture
def runs():
    """The functions that were run, each with its thread."""
    return []


@pytest.fixture
def logic(scene, scenario, work, runs):
    def run(function, *arguments, **named):
        runs.append((function, threading.get_ident()))
        return runHere(function, *arguments, **named)

    return ScenarioLogic(scene, Cache(scenario), asset_path("robots", "iiwa7"), run, work)


def volume(scene, values, spacing):
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "MRI")
    slicer.util.updateVolumeFromArray(node, values)
    node.SetSpacing(spacing, spacing, spacing)
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
    logic.setRobotShown(True)
    in_turns(work)
    scene.Clear(0)
    logic.forgetScene()
    assert not logic.isRobotShown
    logic.setRobotShown(True)
    in_turns(work)
    assert missingLinks(scene) == []
    assert len(runs) == 1


def test_a_robot_that_is_hidden_or_cleared_while_it_comes_stays_away(scene, logic, work):
    def clear():
        scene.Clear(0)
        logic.forgetScene()

    for end in (lambda: logic.setRobotShown(False), clear):
        logic.setRobotShown(True)
        in_turns(work, end)
        assert not logic.isRobotShown
        assert len(missingLinks(scene)) >= 7


def test_a_robot_whose_files_are_missing_is_reported(scene, scenario, work, tmp_path):
    logic = ScenarioLogic(scene, Cache(scenario), tmp_path, runHere, work)
    problems = []
    logic.problemFound.connect(problems.append)
    logic.setRobotShown(True)
    in_turns(work)
    (problem,) = problems
    assert problem.startswith("The robot cannot be shown. There is no file")
    assert not logic.isRobotShown


def test_a_scene_that_is_cleared_while_a_scenario_comes_stays_empty(scene, logic, work):
    logic.show("ball", "task-1")
    work.process()
    scene.Clear(0)
    work.forgetScene()
    in_turns(work)
    assert Role.TARGET.find(scene) is None


def ball():
    grid = np.indices((50, 50, 50)) - 25.0
    return (np.linalg.norm(grid, axis=0) < 20).astype(np.float32) * 100.0


def test_a_head_that_is_shown_while_another_is_searched_gives_way_to_it(scene, logic, work):
    def show(_step, _share):
        if Role.HEAD_MODEL.find(scene) is None:
            logic.show("ball", "task-1")
            in_turns(work)

    model, _warnings = logic.useHead(volume(scene, ball(), 3.0), show)
    assert Role.HEAD_MODEL.all(scene) == [model]


def test_a_canceled_search_for_another_head_leaves_the_head(scene, logic, work):
    def cancel(_step, _share):
        raise InputError("Canceled")

    logic.show("ball", "task-1")
    in_turns(work)
    shown = Role.HEAD_MODEL.find(scene)
    with pytest.raises(InputError, match="Canceled"):
        logic.useHead(volume(scene, ball(), 3.0), cancel)
    assert Role.HEAD_MODEL.all(scene) == [shown]
    assert shown.GetDisplayVisibility()


def test_a_scenario_is_shown_and_the_skin_of_a_volume_becomes_the_head(scene, logic, work):
    with pytest.raises(InputError, match="no such task"):
        logic.show("ball", "task-9")
    assert not work.isBusy
    logic.show("ball", "task-1")
    in_turns(work)
    assert isApplied(Role.WORLD_TO_HEAD.find(scene))
    former = Role.HEAD_MODEL.find(scene)
    model, warnings = logic.useHead(volume(scene, ball(), 3.0))
    assert Role.HEAD_MODEL.find(scene) is model
    assert model.GetName() == "Head of MRI"
    assert not former.GetDisplayVisibility()
    bounds = np.array(model.GetPolyData().GetBounds())
    np.testing.assert_allclose(bounds[1] - bounds[0], 2 * 20 * 3.0, atol=4.0)
    assert "The slices are 3.0 mm apart" in warnings[0]


def test_a_broken_volume_is_reported_and_the_head_stays(scene, logic, work):
    logic.show("ball", "task-1")
    in_turns(work)
    shown = Role.HEAD_MODEL.find(scene)
    with pytest.raises(InputError, match="not numbers"):
        logic.useHead(volume(scene, np.full((60, 60, 60), np.nan, np.float32), 3.0))
    assert Role.HEAD_MODEL.find(scene) is shown
    assert shown.GetDisplayVisibility()
    with pytest.raises(InputError, match="holds no image"):
        logic.useHead(scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode", "Empty"))
