"""Nothing of a closed scene is mistaken for part of the next one, whose nodes have the same IDs."""

import uuid
from pathlib import Path

import numpy as np
import pytest
import slicer

from rastrainer.errors import InputError
from rastrainer.journal.recording import find_track
from rastrainer.scenario.points import LABELS
from rastrainer.sections import scenario_logic
from rastrainer.sections.new_scenario_logic import NewScenarioOptions
from rastrainer.sections.score_logic import SLICES_A_TURN
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.slicer.scene.robot_description import toolPoses
from rastrainer.slicer.scene.trial_replay import STATES_A_SLICE, showReplay
from Testing.slicer.recorded_trial import (
    URDF,
    put_touches,
    store_trial_on_colin,
    touches_on_colin,
    write_recorded_trial,
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


def test_a_replay_in_the_next_scene_does_not_stop_where_the_previous_one_would_have(
    host, session, make_record, tmp_path
):
    record = make_record(str(uuid.UUID(int=1)), trainee="T001", scenario="colin27")
    store_trial_on_colin(host, record, 2)
    write_recorded_trial(Path.home() / "RASTrainer" / "trials", record["trialId"], 16.0)
    trial = session.trainees.study.trial(record["trialId"])
    session.replay.showWorstTouch(trial)
    host.scene.GetFirstNodeByName("Replay of T001, task-1").SetPlaybackActive(False)
    host.save_scene(tmp_path / "replay.mrb")
    host.load_scene(tmp_path / "replay.mrb")
    browser = host.scene.GetFirstNodeByName("Replay of T001, task-1")
    browser.SetSelectedItemNumber(browser.GetNumberOfItems() - 1)
    browser.SetPlaybackActive(True)
    session.replay.process()
    assert browser.GetPlaybackActive()


def test_a_long_replay_in_a_closed_scene_is_released_gradually(host, session, tmp_path):
    trial_id = str(uuid.UUID(int=1))
    write_recorded_trial(tmp_path, trial_id, 60.0)
    track = find_track(tmp_path, trial_id)
    showReplay(host.scene, "T", track, toolPoses(URDF, track.q), np.eye(4))
    tool = host.scene.GetFirstNodeByName("T: tool sequence")
    count = tool.GetNumberOfDataNodes()
    a_turn = SLICES_A_TURN * STATES_A_SLICE
    assert count > a_turn
    host.scene.Clear(0)
    assert tool.GetNumberOfDataNodes() == count
    session.replay.process()
    assert 0 < count - tool.GetNumberOfDataNodes() <= a_turn
    while session.replay.isReleasing:
        session.replay.process()
    assert tool.GetNumberOfDataNodes() == 0


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
