"""A scenario in the scene: head, skull, plan and the fiducials of a task."""

import os
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.head.mesh import write_head_mesh
from rastrainer.scenario.points import PlannedTarget, PlannedTrajectory
from rastrainer.scenario.scenario import SkullFile, SkullKind
from rastrainer.slicer.scene import scenario_nodes as shown
from rastrainer.slicer.scene.nodes import Role, labelsOf, worldPoints
from rastrainer.slicer.scene.scenario_nodes import showTask
from Testing.domain.scenario.made_up_scenario import ball_head
from Testing.slicer.shown_scenario import show_whole


@pytest.fixture
def planned(scenario):
    """The scenario with a further target, a trajectory and an approximate skull."""
    path = scenario.folder / "skull.ply"
    write_head_mesh(path, ball_head(80.0))
    return replace(
        scenario,
        name="planned",
        targets=(PlannedTarget("Cyst", np.array([10.0, 20.0, 30.0])),),
        trajectory=PlannedTrajectory("Biopsy", np.array([0.0, 0.0, 90.0]), np.array([1.0, 2, 3])),
        skull=SkullFile(path, SkullKind.APPROXIMATION),
    )


def test_targets_trajectory_and_skull_are_shown_and_go_if_the_next_scenario_lacks_them(
    scene, planned, scenario
):
    show_whole(scene, planned)
    targets = Role.TARGET.find(scene)
    assert labelsOf(targets) == ("center", "Cyst")
    np.testing.assert_allclose(worldPoints(targets), [[0, 10, -20], [10, 20, 30]])
    line = Role.TRAJECTORY.find(scene)
    assert (line.GetName(), labelsOf(line)) == ("Biopsy", ("Entry", "Target"))
    np.testing.assert_allclose(worldPoints(line), [[0, 0, 90], [1, 2, 3]])
    for role, radius in ((Role.HEAD_MODEL, 90.0), (Role.SKULL, 80.0)):
        bounds = role.find(scene).GetPolyData().GetBounds()
        np.testing.assert_allclose(bounds, [-radius, radius] * 3, atol=1.0)
    skull = Role.SKULL.find(scene)
    assert skull.GetName() == "Skull (approximation)"
    assert Role.HEAD_MODEL.find(scene).GetDisplayNode().GetOpacity() < 1.0
    bone = SkullFile(planned.skull.file, SkullKind.BONE)
    show_whole(scene, replace(planned, name="ct", skull=bone))
    assert skull.GetName() == "Skull"
    show_whole(scene, scenario)
    assert Role.TRAJECTORY.find(scene) is None
    assert Role.SKULL.find(scene) is None
    assert labelsOf(Role.TARGET.find(scene)) == ("center",)
    assert Role.HEAD_MODEL.find(scene).GetDisplayNode().GetOpacity() == 1.0


def test_a_scenario_rebuilt_under_its_name_is_shown_again(scene, planned):
    show_whole(scene, planned)
    showTask(scene, planned, "task-1").SetName("my points")
    for path, radius in ((planned.head, 70.0), (planned.skull.file, 60.0)):
        later = path.stat().st_mtime + 1.0
        write_head_mesh(path, ball_head(radius))
        os.utime(path, (later, later))
    task = planned.task("task-1")
    moved = replace(task, fiducials=task.fiducials * 70.0 / 90.0)
    rebuilt = replace(planned, tasks=(moved,))
    show_whole(scene, rebuilt)
    node = showTask(scene, rebuilt, "task-1")
    for role, radius in ((Role.HEAD_MODEL, 70.0), (Role.SKULL, 60.0)):
        bounds = role.find(scene).GetPolyData().GetBounds()
        np.testing.assert_allclose(bounds, [-radius, radius] * 3, atol=1.0)
    np.testing.assert_allclose(worldPoints(node), moved.fiducials)
    assert labelsOf(node) == tuple(str(number) for number in range(1, 16))
    assert node.GetLocked()
    assert len(Role.FIXED_FIDUCIALS.all(scene)) == 1


def test_a_shown_mesh_is_not_read_again_and_a_missing_one_is_reported(scene, planned, monkeypatch):
    show_whole(scene, planned)
    count = scene.GetNumberOfNodes()
    with monkeypatch.context() as patch:
        patch.setattr(shown, "read_head_mesh", None)
        show_whole(scene, planned)
    assert scene.GetNumberOfNodes() == count
    planned.head.unlink()
    (problem,) = show_whole(scene, planned)
    assert problem.startswith("No head is shown: The mesh ")
    assert Role.HEAD_MODEL.find(scene) is None
