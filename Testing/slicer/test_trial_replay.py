"""A recorded trial is a Sequence: tool, touches and clearance over the trial's time."""

import re

import numpy as np
import pytest
import vtk

from rastrainer.errors import InputError
from rastrainer.journal.recording import find_track
from rastrainer.slicer.scene.robot_description import toolPoses
from rastrainer.slicer.scene.trial_replay import (
    findReplay,
    goTo,
    moment,
    removeReplay,
    showReplay,
)
from rastrainer_headless.scene import HeadlessScene
from Testing.slicer.recorded_trial import URDF, write_recorded_trial
from Testing.slicer.scene_bundle import load_bundle

TRIAL = "00000000-0000-0000-0000-000000000001"
WORLD_TO_HEAD = np.array(
    [[0.0, 1, 0, 5], [-1, 0, 0, -20], [0, 0, 1, -300], [0, 0, 0, 1]], dtype=float
)


@pytest.fixture
def tips(tmp_path):
    return write_recorded_trial(tmp_path, TRIAL)


def show(scene, folder, name="Trial 1", **options):
    track = find_track(folder, TRIAL)
    return showReplay(scene, name, track, toolPoses(URDF, track.q), WORLD_TO_HEAD, **options)


@pytest.fixture
def replayed(scene, tips, tmp_path):  # noqa: ARG001 (the journal is needed)
    return show(scene, tmp_path)


def node(scene, name):
    found = scene.GetFirstNodeByName(f"Trial 1: {name}")
    assert found is not None, name
    return found


def tip_in_scene(scene):
    """Return where the needle's tip is shown, RAS mm."""
    matrix = vtk.vtkMatrix4x4()
    node(scene, "tool").GetMatrixTransformToWorld(matrix)
    return np.array([matrix.GetElement(row, 3) for row in range(3)])


def test_the_tool_is_where_it_was_at_every_time(scene, replayed, tips):
    assert replayed.GetNumberOfItems() == pytest.approx(30, abs=1)
    for seconds in (0.02, 1.0, 2.98):
        goTo(scene, seconds)
        shown, said = moment(scene)
        assert 0.0 <= seconds - shown + 1e-6 < 0.12
        tip = tips[round(shown / 0.02) - 1]
        expected = WORLD_TO_HEAD[:3, :3] @ tip + WORLD_TO_HEAD[:3, 3]
        np.testing.assert_allclose(tip_in_scene(scene), expected, atol=1e-6)
        assert said == f"{30.0 - 5.0 * shown:.1f} mm"


def test_touches_and_trace_appear_as_they_were_made_are_saved_and_leave_with_the_replay(
    headless_scene, scene, tmp_path
):
    tips = write_recorded_trial(tmp_path, TRIAL, traced=45)
    replayed = show(scene, tmp_path)
    headless_scene.save(tmp_path / "trial.mrb")
    again = HeadlessScene()
    load_bundle(again, tmp_path / "trial.mrb")
    assert findReplay(again.scene).GetNumberOfItems() == replayed.GetNumberOfItems()
    goTo(again.scene, 3.0)
    assert node(again.scene, "trace").GetPolyData().GetNumberOfPoints() == 45
    counts = []
    for seconds in (0.02, 0.3, 0.5, 1.1, 2.5, 3.0):
        goTo(scene, seconds)
        touches = node(scene, "touches").GetNumberOfControlPoints()
        counts.append((node(scene, "trace").GetPolyData().GetNumberOfPoints(), touches))
    assert counts == [(0, 0), (10, 0), (20, 0), (45, 1), (45, 2), (45, 3)]
    assert node(scene, "touches").GetNthControlPointLabel(2) == "3"
    trace = node(scene, "trace")
    last = np.array(trace.GetPolyData().GetPoint(44))
    np.testing.assert_allclose(last, tips[44], atol=1e-3)
    assert trace.GetParentTransformNode() is node(scene, "WorldToHead")
    write_recorded_trial(tmp_path / "other", TRIAL, seconds=1.0)
    show(scene, tmp_path / "other", "Trial 2")
    assert scene.GetFirstNodeByName("Trial 1: trace") is None
    removeReplay(scene)
    assert (findReplay(scene), moment(scene)) == (None, None)
    goTo(scene, 1.0)


def test_a_missing_journal_or_one_from_another_robot_is_reported(scene, tips, tmp_path):  # noqa: ARG001
    track, longer = find_track(tmp_path, TRIAL), tmp_path / "longer.urdf"
    longer.write_text(re.sub(r'xyz="0 0 0\.(?=\d)', 'xyz="0 0 1.', URDF.read_text()))
    with pytest.raises(InputError, match="another robot"):
        showReplay(scene, "Trial 1", track, toolPoses(longer, track.q), WORLD_TO_HEAD)
    with pytest.raises(InputError, match="another robot"):
        toolPoses(URDF, track.q[:, :6])
    assert findReplay(scene) is None
    with pytest.raises(InputError, match="only on the computer whose simulator recorded it"):
        find_track(tmp_path, TRIAL[:-1] + "2")
