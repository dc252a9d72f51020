"""The slice views go through the next point of a trial, or follow the tool."""

import numpy as np
import pytest
from slicer.util import vtkMatrixFromArray

from rastrainer import transforms
from rastrainer.protocol import DeviceName
from rastrainer.sections.views import LEAST_MOVE_MM, PERIOD_S, SliceFollower, jumpTo, poseOnHead
from rastrainer.slicer.scene.nodes import Role, poseKind, prepareNodes
from rastrainer.slicer.scene.scenario_nodes import showTask
from rastrainer.slicer.scene.trial_scene import showPlannedPlace
from rastrainer.slicer.settings import (
    SLICES_FOLLOW_TOOL,
    SLICES_LIE_ALONG,
    SLICES_SHOW_NEXT_POINT,
    Settings,
)

TIP = np.array([480.0, -60.0, 330.0])
UP = np.array([0.0, 0.0, 20.0])


@pytest.fixture
def follower(room):
    return SliceFollower(room.scene, room.logic, Settings(), lambda: room.now)


def place(scene):
    """Where the slice views meet, (3,), RAS mm."""
    planes = {"Yellow": 0, "Green": 1, "Red": 2}
    return np.array(
        [
            scene.GetNodeByID(f"vtkMRMLSliceNode{name}").GetSliceToRAS().GetElement(axis, 3)
            for name, axis in planes.items()
        ]
    )


def play(room, follower, point, task="task-1"):
    """Have the simulator send the next point."""
    room.tell(nextPoint=point, task=task)
    wanted = (point, task)
    room.run_until(lambda: (room.logic.status.nextPoint, room.logic.status.task) == wanted)
    room.run_until(lambda: room.node(Role.FIXED_FIDUCIALS) is not None)
    follower.process()


def put_tool(scene, tip):
    list(prepareNodes(scene))
    pose = poseKind(DeviceName.TOOL_TIP_TO_WORLD).find(scene)
    pose.SetMatrixTransformToParent(vtkMatrixFromArray(transforms.rigid(np.eye(3), tip)))


def stand(room, scenario):
    """Place the head in World as planned."""
    fixed = showTask(room.scene, scenario, "task-1")
    showPlannedPlace(room.scene, scenario, fixed)


def test_the_slices_jump_to_each_next_point_of_a_trial_unless_the_user_wants_it_otherwise(
    room, follower, scenario
):
    fiducials = scenario.task("task-1").fiducials
    for label in ("1", "2", "15"):
        play(room, follower, label)
        np.testing.assert_allclose(place(room.scene), fiducials[int(label) - 1], atol=1e-3)
    # Scrolled slices stay until another point is next.
    jumpTo(room.scene, (1.0, 2.0, 3.0))
    follower.process()
    np.testing.assert_allclose(place(room.scene), [1, 2, 3])
    play(room, follower, "2")
    np.testing.assert_allclose(place(room.scene), fiducials[1], atol=1e-3)
    follower.settings.set(SLICES_SHOW_NEXT_POINT, False)
    play(room, follower, "1")
    np.testing.assert_allclose(place(room.scene), fiducials[1], atol=1e-3)
    follower.settings.set(SLICES_SHOW_NEXT_POINT, True)
    room.tell(phase="idle", nextPoint="3")
    room.run_until(lambda: room.logic.status.phase == "idle")
    follower.process()
    np.testing.assert_allclose(place(room.scene), fiducials[1], atol=1e-3)


def test_points_are_shown_once_their_fiducials_are_and_again_in_a_cleared_scene(
    room, follower, scenario
):
    showTask(room.scene, scenario, "task-2")
    jumpTo(room.scene, (1.0, 2.0, 3.0))
    room.tell(nextPoint="1", task="task-1", phase="running", trialId="")
    room.run_until(lambda: room.logic.status.nextPoint == "1")
    follower.process()
    np.testing.assert_allclose(place(room.scene), [1, 2, 3])
    showTask(room.scene, scenario, "task-1")
    follower.process()
    first = scenario.task("task-1").fiducials[0]
    np.testing.assert_allclose(place(room.scene), first, atol=1e-3)
    room.scene.Clear(False)
    follower.forgetScene()
    jumpTo(room.scene, (0.0, 0.0, 0.0))
    showTask(room.scene, scenario, "task-1")
    follower.process()
    np.testing.assert_allclose(place(room.scene), first, atol=1e-3)


def test_the_slices_follow_a_registered_tool_rarely_and_only_its_motion(room, follower, scenario):
    follower.settings.set(SLICES_FOLLOW_TOOL, True)
    list(prepareNodes(room.scene))
    stand(room, scenario)
    follower.process()
    assert poseOnHead(room.scene, DeviceName.TOOL_TIP_TO_WORLD) is None
    put_tool(room.scene, TIP)
    play(room, follower, "1")
    first = transforms.apply(transforms.inverse(scenario.head_to_world), TIP)
    np.testing.assert_allclose(place(room.scene), first, atol=1e-3)
    put_tool(room.scene, TIP + UP)
    follower.process()
    np.testing.assert_allclose(place(room.scene), first, atol=1e-3)
    room.now += PERIOD_S
    follower.process()
    np.testing.assert_allclose(place(room.scene), first + UP, atol=1e-3)
    room.now += PERIOD_S
    put_tool(room.scene, TIP + UP + [0.9 * LEAST_MOVE_MM, 0.0, 0.0])
    follower.process()
    np.testing.assert_allclose(place(room.scene), first + UP, atol=1e-3)
    # In a cleared scene, they go to a tool that has not moved.
    room.scene.Clear(False)
    follower.forgetScene()
    jumpTo(room.scene, (0.0, 0.0, 0.0))
    stand(room, scenario)
    put_tool(room.scene, TIP + UP)
    room.now += PERIOD_S
    follower.process()
    np.testing.assert_allclose(place(room.scene), first + UP, atol=1e-3)
    follower.settings.set(SLICES_FOLLOW_TOOL, False)
    follower.process()
    fiducial = scenario.task("task-1").fiducials[0]
    np.testing.assert_allclose(place(room.scene), fiducial, atol=1e-3)


def put_instrument(scene, tip, direction):
    list(prepareNodes(scene))
    pose = poseKind(DeviceName.INSTRUMENT_TIP_TO_WORLD).find(scene)
    across = np.cross(direction, [0.3, 0.9, 0.1])
    across /= np.linalg.norm(across)
    axes = np.column_stack([across, np.cross(direction, across), direction])
    pose.SetMatrixTransformToParent(vtkMatrixFromArray(transforms.rigid(axes, tip)))


def axes_of(scene, name):
    matrix = scene.GetNodeByID(f"vtkMRMLSliceNode{name}").GetSliceToRAS()
    return np.array([[matrix.GetElement(row, column) for column in range(4)] for row in range(3)])


def test_the_slices_align_with_drill_and_instrument_if_wanted_and_are_then_restored(
    room, follower, scenario
):
    stand(room, scenario)
    before = {name: axes_of(room.scene, name)[:, :3] for name in ("Red", "Green", "Yellow")}
    direction = np.array([0.2, -0.3, -0.93])
    direction /= np.linalg.norm(direction)
    put_instrument(room.scene, TIP, direction)
    room.tell(phase="drilling")
    room.run_until(lambda: room.logic.status.phase == "drilling")
    assert follower.needsPoses
    follower.process()
    to_head = transforms.inverse(scenario.head_to_world)
    tip, along = transforms.apply(to_head, TIP), to_head[:3, :3] @ direction
    for name, normal_along in (("Red", 1.0), ("Green", 0.0), ("Yellow", 0.0)):
        axes = axes_of(room.scene, name)
        np.testing.assert_allclose(axes[:, 3], tip, atol=1e-4)
        assert abs(axes[:, 2] @ along) == pytest.approx(normal_along, abs=1e-6)
        # Like Slicer's own views: their axes are left-handed or right-handed.
        turned = np.linalg.det(axes[:, :3]), np.linalg.det(before[name])
        assert turned[0] == pytest.approx(turned[1])
    room.tell(phase="registered")
    room.run_until(lambda: room.logic.status.phase == "registered")
    follower.process()
    for name, axes in before.items():
        np.testing.assert_allclose(axes_of(room.scene, name)[:, :3], axes)
    follower.settings.set(SLICES_LIE_ALONG, False)
    room.tell(phase="inserting")
    room.run_until(lambda: room.logic.status.phase == "inserting")
    follower.process()
    assert not follower.needsPoses
    np.testing.assert_allclose(axes_of(room.scene, "Red")[:, :3], before["Red"])
