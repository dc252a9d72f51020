"""A plan on the MRI reaches the robot, and its true error is shown when the head is known."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.scenario.points import LABELS, PlannedTarget, PlannedTrajectory
from rastrainer.sections.registration_logic import RegistrationLogic
from rastrainer.sections.target_plan_logic import PlanLogic, targetsOf
from rastrainer.slicer.scene.nodes import Role, setPoints, worldPoints
from rastrainer.slicer.scene.scenario_nodes import showTask
from rastrainer.trial.analysis import RevealedTruth
from Testing.slicer.shown_scenario import show_whole
from Testing.slicer.simulator_double import LinkedLab, run_until_received
from Testing.slicer.work_at_once import WorkAtOnce

TUMOR = np.array([20.0, -30.0, 40.0])
ENTRY = np.array([60.0, -40.0, 70.0])


class Room(LinkedLab):
    def __init__(self, scene, scenario):
        super().__init__(scene, lambda name, _a: {} if name == "Hello" else self.reply)
        self.head_to_world = scenario.perturbed_head_to_world(4)
        self.reply = {"reachable": True, "reason": ""}
        show_whole(scene, scenario)
        showTask(scene, scenario, "task-1")
        fiducials = scenario.task("task-1").fiducials
        noise = np.random.default_rng(8).normal(0.0, 0.5, (15, 3))
        self.touched = transforms.apply(self.head_to_world, fiducials + noise)
        self.registration = RegistrationLogic(scene, WorkAtOnce())
        self.logic = PlanLogic(scene, self.link, self.registration)

    def register(self):
        setPoints(Role.CAPTURED_POINTS.make(self.scene), LABELS, self.touched)
        self.registration.process()

    def target(self, *points):
        kind = Role.PLAN_TARGET if len(points) == 1 else Role.PLAN_TRAJECTORY
        node = self.logic.points.ready(kind)
        for point in points:
            node.AddControlPoint(*point)
        return node

    def reveal(self):
        truth = RevealedTruth(tuple(self.head_to_world.ravel()), 0.4)
        self.logic.takeTruth(SimpleNamespace(truth=truth))


@pytest.fixture
def room(scene, scenario):
    room = Room(scene, scenario)
    yield room
    room.close()


def test_a_target_or_trajectory_is_mapped_into_world_with_its_expected_error(room):
    room.register()
    plan = room.logic.read(room.target(TUMOR))
    shown = room.registration.comparison.shown
    np.testing.assert_allclose(transforms.apply(shown.matrix, plan.endsWorld), [TUMOR])
    there = transforms.apply(room.head_to_world, TUMOR[None])[0]
    assert np.linalg.norm(plan.endsWorld[-1] - there) < 1.5
    assert plan.expected == room.registration.comparison.targetError(TUMOR)
    assert len(plan.ends) == 1
    plan = room.logic.read(room.target(ENTRY, TUMOR))
    np.testing.assert_allclose(plan.ends, [ENTRY, TUMOR])
    length = np.linalg.norm(plan.endsWorld[0] - plan.endsWorld[1])
    assert length == pytest.approx(np.linalg.norm(ENTRY - TUMOR))


def test_targets_and_trajectory_of_a_scenario_are_plans_that_stay(scene, scenario):
    has_plan = replace(
        scenario,
        targets=(PlannedTarget("Tumor", TUMOR),),
        trajectory=PlannedTrajectory("Biopsy", ENTRY, TUMOR),
    )
    room = Room(scene, has_plan)
    room.register()
    targets = Role.TARGET.find(scene)
    assert targetsOf(targets) == ("center", "Tumor")
    first, second = (room.logic.read(targets, row) for row in (0, 1))
    assert (first.name, second.name) == ("center", "Tumor")
    np.testing.assert_allclose([*first.ends, *second.ends], [scenario.target.position_ras, TUMOR])
    assert second.expected == room.registration.comparison.targetError(TUMOR)
    plan = room.logic.read(Role.TRAJECTORY.find(scene))
    assert plan.name == "Biopsy"
    np.testing.assert_allclose(plan.ends, [ENTRY, TUMOR])
    with pytest.raises(InputError, match="belong to the scenario"):
        room.logic.points.removePoint(targets)
    room.close()


def test_the_plan_is_shown_to_the_trainee_and_the_simulators_answer_to_the_user(room):
    room.register()
    room.connect()
    room.logic.send(room.target(ENTRY, TUMOR))
    room.run_until(lambda: room.logic.isReachable is not None)
    ((name, arguments),) = [c for c in room.simulator.commands if c[0] != "Hello"]
    assert (name, arguments["name"]) == ("PlanTarget", "Planned trajectory")
    assert len(arguments["positionMm"]) == len(arguments["entryMm"]) == 3
    assert "can carry it out" in room.logic.sentence
    room.reply = {"reachable": False, "reason": "The target is out of the robot's reach."}
    room.logic.send(room.target(TUMOR))
    room.run_until(lambda: room.logic.isReachable is False)
    assert room.logic.sentence.endswith("out of the robot's reach.")
    room.reply = "The trial is not registered yet."
    room.logic.send(room.target(TUMOR))
    room.run_until(lambda: room.logic.sentence == room.reply)
    assert room.logic.isReachable is None


def test_the_answer_and_the_true_error_are_shown_but_not_for_another_plan(room):
    room.register()
    room.connect()
    node = room.target(TUMOR)

    def another_registration():
        room.touched[3] += 5.0
        room.register()
        return room.logic.read(node)

    def another_point():
        node.SetNthControlPointPosition(0, *ENTRY)
        return room.logic.read(node)

    for change in (lambda: None, another_registration, another_point):
        room.logic.send(node)
        room.run_until(lambda: room.logic.isReachable)
        assert room.logic.trueErrorMm is None
        room.reveal()
        room.logic.follow(room.logic.read(node))
        assert room.logic.isReachable is True
        target = worldPoints(node)
        found = room.registration.comparison.shown.matrix @ room.head_to_world
        error = np.linalg.norm(transforms.apply(found, target) - target)
        assert room.logic.trueErrorMm == pytest.approx(error)
        room.logic.follow(change())
        assert room.logic.isReachable is room.logic.trueErrorMm is None
        assert "The plan has changed" in room.logic.sentence
        room.logic.forgetTruth()
    # Late answers do not count.
    room.logic.send(node)
    node.SetNthControlPointPosition(0, *TUMOR)
    room.logic.follow(room.logic.read(node))
    run_until_received(room.link)
    assert room.logic.isReachable is None


def test_placing_erases_nothing_and_each_change_of_what_is_there_can_be_undone(room):
    points = room.logic.points
    node = room.target(TUMOR)
    assert room.target(ENTRY) is node
    assert node.GetNumberOfControlPoints() == 2
    label = node.GetNthControlPointLabel(0)
    points.removePoint(node, 0)
    points.undo()
    np.testing.assert_allclose(worldPoints(node), [TUMOR, ENTRY])
    assert node.GetNthControlPointLabel(0) == label
    points.undo()
    np.testing.assert_allclose(worldPoints(node), [TUMOR])
    points.ready(Role.PLAN_TARGET)
    line = room.target(ENTRY, TUMOR)
    second = room.target(TUMOR, ENTRY)
    assert second is not line
    np.testing.assert_allclose(worldPoints(line), [ENTRY, TUMOR])
    room.scene.RemoveNode(second)
    room.scene.RemoveNode(line)
    points.undo()
    assert node.GetNumberOfControlPoints() == 0
    assert not points.canUndo
