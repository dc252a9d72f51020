"""Trials are started and steered from Slicer, and shown while they are played."""

import numpy as np
import pytest
from slicer.util import arrayFromTransformMatrix

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.igtl.content import Point, Points
from rastrainer.protocol import DeviceName
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.trial_scene import KIND_ATTRIBUTE, PLANNED, isApplied
from Testing.slicer.training_room import LOADING_REFUSAL


def test_a_loading_scenario_prevents_trials_until_it_is_loaded_or_refused(room):
    done = []
    room.run_until(lambda: not room.logic.obstacle)
    room.logic.loadScenario("mine", lambda: done.append(True))
    assert "still loading a scenario" in room.logic.obstacle
    room.run_until(lambda: done)
    assert not room.logic.obstacle
    room.refusal = "There is no such scenario."
    room.logic.loadScenario("nowhere", lambda: done.append(True))
    assert room.logic.loadings
    room.run_until(lambda: room.answers[-1:] == [room.refusal])
    assert (len(done), room.logic.obstacle) == (1, "")


def test_a_refused_trial_is_reported_in_the_simulators_words_and_may_start_later(room):
    with pytest.raises(InputError, match="Choose a trainee"):
        room.logic.start("", "task-2", "hmd")
    with pytest.raises(InputError, match="Choose a task"):
        room.logic.start("T001", "", "hmd")
    room.isLoading = True
    room.logic.start("T001", "task-2", "hmd")
    room.run_until(lambda: room.answers)
    assert room.sent("StartTask") == [{"task": "task-2", "trainee": "T001", "mode": "hmd"}]
    room.isLoading = False
    room.logic.start("T001", "task-2", "hmd")
    room.run_until(lambda: len(room.answers) == 2)
    room.refusal = "A trial is open: Register or Abort it first."
    room.logic.start("T001", "task-1", "desktop")
    room.run_until(lambda: len(room.answers) == 3)
    assert room.answers == [LOADING_REFUSAL, "", room.refusal]
    room.link.disconnect()
    assert room.logic.obstacle == "Connect to the simulator first."


def test_the_trial_run_waits_for_the_tutorial_if_the_simulator_requires_it(room):
    room.needsTutorial = True
    room.logic.start("T001", "trial-run", "desktop", isTutorialFirst=True)
    room.run_until(lambda: room.answers)
    assert room.sent("StartTutorial") == [{"trainee": "T001", "mode": "desktop"}]
    assert room.all_sent("StartTask") == []
    assert room.answers[-1].startswith("T001 does the tutorial first")
    assert room.logic.learner == "T001"
    room.needsTutorial = False
    room.logic.start("T001", "trial-run", "desktop", isTutorialFirst=True)
    room.run_until(lambda: room.sent("StartTask"))
    assert room.sent("StartTask") == [{"task": "trial-run", "trainee": "T001", "mode": "desktop"}]
    room.tell(task="trial-run")
    room.run_until(lambda: not room.logic.learner)
    # Only the trial run waits, and only on request, and not where it is refused.
    room.needsTutorial = True
    room.logic.start("T001", "task-1", "desktop", isTutorialFirst=True)
    room.logic.start("T001", "trial-run", "desktop")
    room.run_until(lambda: len(room.sent("StartTask")) == 3)
    room.refusal = "P07 is doing the tutorial."
    room.logic.start("T001", "trial-run", "desktop", isTutorialFirst=True)
    room.run_until(lambda: room.answers[-1:] == [room.refusal])
    assert len(room.all_sent("StartTask")) == 3


def test_fiducials_and_touches_are_on_the_planned_head_while_the_trial_runs(room, scenario):
    room.tell()
    room.run_until(lambda: room.node(Role.WORLD_TO_HEAD))
    assert room.node(Role.HEAD_MODEL) is not None
    fiducial = scenario.task("task-1").fiducials[0]
    fixed = room.node(Role.FIXED_FIDUCIALS)
    np.testing.assert_allclose(fixed.GetNthControlPointPosition(0), fiducial, atol=1e-4)
    touched = transforms.apply(scenario.head_to_world, fiducial[None])[0]
    points = Points((Point("1", tuple(touched)),))
    room.simulator.send(DeviceName.CAPTURED_POINTS, points, {"count": "1"})
    room.run_until(lambda: Role.CAPTURED_POINTS.make(room.scene).GetNumberOfControlPoints() == 1)
    transform = room.node(Role.WORLD_TO_HEAD)
    assert transform.GetAttribute(KIND_ATTRIBUTE) == PLANNED
    assert isApplied(transform)
    np.testing.assert_allclose(
        arrayFromTransformMatrix(transform) @ scenario.head_to_world, np.eye(4), atol=1e-9
    )
    shown = Role.CAPTURED_POINTS.make(room.scene).GetNthControlPointPositionWorld(0)
    np.testing.assert_allclose(shown, fiducial, atol=1e-3)
    assert room.logic.status.touched == 1


def test_progress_contains_the_next_point_the_proximity_and_the_running_time(room):
    room.tell(elapsedS=None, nextPoint=None)
    room.run_until(lambda: room.logic.status.phase == "running")
    assert room.logic.status.nextPoint == "", "invalid values are ignored"
    room.tell(nextPoint="4", proximity="proximity", elapsedS=30.0)
    room.run_until(lambda: room.logic.status.nextPoint == "4")
    room.now += 5.0
    progress = room.logic.status
    assert (progress.proximity, progress.isOpen) == ("proximity", True)
    assert progress.elapsedS == 35.0
    room.tell(phase="paused", elapsedS=36.0)
    room.run_until(lambda: room.logic.status.phase == "paused")
    room.now += 5.0
    assert room.logic.status.elapsedS == 36.0


def test_a_cleared_scene_gets_the_running_trial_back_with_its_clock(room):
    room.tell(elapsedS=30.0)
    room.run_until(lambda: room.node(Role.FIXED_FIDUCIALS) is not None)
    room.run_until(lambda: room.logic.status.elapsedS == 30.0)
    room.now += 5.0
    room.scene.Clear(False)
    assert room.node(Role.FIXED_FIDUCIALS) is None
    room.logic.forgetScene()
    assert room.logic.status.elapsedS == 35.0
    room.run_until(lambda: len(room.sent("Hello")) == 2)
    room.tell(elapsedS=36.0)  # The simulator sends its state to everyone who connects.
    room.run_until(lambda: room.node(Role.FIXED_FIDUCIALS) is not None)
    assert room.node(Role.WORLD_TO_HEAD) is not None
