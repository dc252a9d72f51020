"""One tick of everything: input, trial, motion, contact, state. No clock, no socket, no file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from rastrainer.head_mesh import HeadMesh, read_head_mesh
from rastrainer.protocol import CommandName, Phase, Proximity
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.contact import Contact, Moved
from rastrainer_simulator.collision.pressing import Pressing
from rastrainer_simulator.collision.proximity import next_proximity
from rastrainer_simulator.collision.table_clearance import Surroundings
from rastrainer_simulator.joint_motion import JointMotion, Joints
from rastrainer_simulator.motion_command import MM, commanded_motion
from rastrainer_simulator.operator_input import Command, OperatorInput
from rastrainer_simulator.planning.plan_reach import PlanReach
from rastrainer_simulator.posture import Postures
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.scene_view import SceneView
from rastrainer_simulator.setup import SimulationSetup
from rastrainer_simulator.start_posture import start_joints
from rastrainer_simulator.state import (
    Answer,
    Event,
    EventKind,
    Motion,
    PlannedTarget,
    SimulationState,
    StartingPoint,
    StepResult,
)
from rastrainer_simulator.teleoperation.commanded_motion import Outcome
from rastrainer_simulator.teleoperation.teleoperation import Teleoperation, Wish
from rastrainer_simulator.texts.texts import Texts
from rastrainer_simulator.training.phase_rules import refusal
from rastrainer_simulator.training.touch_rule import Moment
from rastrainer_simulator.training.training import Reply, Training
from rastrainer_simulator.training.true_error import Truth
from rastrainer_simulator.vectors import Vector, subtract

if TYPE_CHECKING:
    from rastrainer_simulator.record.interrupted_trial import InterruptedTrial

BEHIND_THE_TOOL = ("links", "self", "table")
"""Parts of the arm that the trainee does not steer and that may still be in the way."""


class Simulation:
    """The robot, the head and the trial.

    `step` is deterministic: the same setup, seed and inputs give the same states to the last bit.
    A trial always starts with the arm above the head and nothing left over from before: a replay
    needs nothing but the trial's own inputs.
    """

    def __init__(self, setup: SimulationSetup, seed: int, texts: Texts | None = None) -> None:
        """Build the scene; takes about a second, most of it for the head's surface."""
        settings = setup.settings
        self.setup = setup
        self._texts = texts or Texts()
        self._training = Training(setup.scenario, seed, settings.training, self._texts)
        self._view = SceneView(setup.scenario, settings.camera, settings.axes)
        self._teleoperation = Teleoperation(settings.teleoperation)
        head = read_head_mesh(setup.scenario.head_mesh)
        self._head_base = head.base / MM
        self._collision = _collision(setup, head)
        kinematics = make_kinematics(setup.robot)
        self.kinematics_name = type(kinematics).__name__
        self._contact = Contact(self._collision, kinematics)
        self._plan_reach = PlanReach(setup.robot, kinematics, self._collision)
        self._postures = Postures(setup.robot)
        self._start = start_joints(setup.robot, setup.scenario, settings.start_height)
        self._joint_motion = JointMotion(setup.robot, self._start, settings.fabrik)
        self._put_in_place()
        self.state = self._state(0, 0.0, Motion.NONE)

    @property
    def truth(self) -> Truth:
        """Where the head is: secret until the trial is scored."""
        return self._training.truth

    @property
    def trial_seed(self) -> int:
        """The seed of the head's pose in the present trial: as secret as the pose."""
        return self._training.trial_seed

    def continue_from(self, point: StartingPoint) -> None:
        """Count ticks, time and revisions on from another simulation, before the first step."""
        self._training.continue_from(point.revision)
        self._view.camera = point.camera or self._view.camera
        self.state = self._state(point.tick, point.sim_time, Motion.NONE)

    def take_up(self, interrupted: InterruptedTrial, point: StartingPoint | None = None) -> None:
        """Go on with a trial of a journal, in place of any other, before the next step.

        The arm stands as in the last sample: where the trainee has left it. `point` tells from
        where ticks, time and view are to go on where that is not the journal's last line.
        """
        point = point or interrupted.point
        self._training.take_up(interrupted.revision_before, interrupted.steps)
        self._put_in_place(interrupted.q)
        self._proximity = interrupted.proximity
        self._is_within_reach = interrupted.is_within_reach
        self._obstacle = interrupted.obstacle
        self._view.camera = point.camera or self._view.camera
        self.state = self._state(point.tick, point.sim_time, Motion.NONE)

    def step(self, dt: float, operator_input: OperatorInput) -> StepResult:
        """Carry out the commands at the state reached, then move on by `dt` seconds."""
        before = self.state
        events: list[Event] = []
        answers: list[Answer] = []
        for command in operator_input.commands:
            reply = self._carry_out(command, before.sim_time)
            events.extend(reply.events)
            answers.append(Answer(command.ticket, reply.ok, reply.message, reply.data))
            if self._training.truth is not self._placed:
                self._put_in_place()
        proximity = self._proximity
        wish = self._wish(dt, operator_input)
        sim_time = before.sim_time + dt
        if wish.ended is not None:
            events.append(_ended(wish.ended, sim_time))
        if wish.motion is not Motion.NONE:
            events.extend(self._move(dt, wish, sim_time))
            if wish.motion is Motion.STICK:
                self._operator = operator_input.operator
        self.state = self._state(before.tick + 1, sim_time, wish.motion)
        if self._proximity is not proximity:
            events.append(_proximity(proximity, self.state, self._pressing, sim_time))
        return StepResult(self.state, tuple(events), tuple(answers))

    def _carry_out(self, command: Command, sim_time: float) -> Reply:
        if self._training.handles(command.name):
            posture = self._posture
            tip_m = posture.clearance.tip_m
            now = Moment(sim_time, posture.tip.position, tip_m, self._pressing.depth)
            return self._training.handle(command, now)
        sentence = refusal(command, self._training.state, self._texts)
        if sentence is not None:
            return Reply(False, sentence)
        arguments = command.arguments
        if command.name == CommandName.LIST_TASKS:
            scenario = self.setup.scenario
            names = {"scenario": scenario.name, "title": scenario.title}
            return Reply(True, data={**names, "tasks": self._tasks()})
        if command.name == CommandName.SET_CAMERA:
            self._view.camera = arguments["camera"]
            return Reply(True, events=(Event(EventKind.CAMERA, sim_time, dict(arguments)),))
        if command.name == CommandName.PLAN_TARGET:
            return self._plan(arguments, sim_time)
        tool = self._posture.tool_axes
        self._teleoperation.start(commanded_motion(command, self._view.camera_axes, tool))
        self._operator = command.sender
        return Reply(True)

    def _plan(self, arguments: Mapping[str, Any], sim_time: float) -> Reply:
        """Show what was planned and answer whether the robot can carry it out."""
        position, entry = (
            None if point is None else tuple(value / MM for value in point)
            for point in (arguments["positionMm"], arguments["entryMm"])
        )
        answer = self._plan_reach.judge(position, entry)
        self._view.planned_target = PlannedTarget(
            arguments["name"], position, entry, answer.reachable
        )
        event = Event(EventKind.PLAN, sim_time, {**arguments, "reachable": answer.reachable})
        return Reply(True, data=answer._asdict(), events=(event,))

    def _tasks(self) -> list[dict[str, object]]:
        return [
            {"name": task.name, "title": task.title, "complexity": task.complexity}
            for task in self.setup.scenario.tasks
        ]

    def _wish(self, dt: float, operator_input: OperatorInput) -> Wish:
        """Return what the operator wants; while the trial is paused the arm stands still."""
        if self._training.state.phase is Phase.PAUSED:
            stopped = self._teleoperation.stop()
            return Wish(Motion.NONE, ended=Outcome.STOPPED if stopped else None)
        axes = self._view.stick_axes
        posture = self._posture
        return self._teleoperation.step(dt, operator_input, posture.tip, axes, posture.surface)

    def _put_in_place(self, q: Joints | None = None) -> None:
        """Put the head where the trial has it, and the arm where trials start, or at `q`."""
        self._placed = self._training.truth
        head_to_world = np.array(self._placed.head_to_world)
        head_to_world[:3, 3] /= MM
        self._head_to_world = head_to_world
        self._stand_to_world = np.eye(4)
        self._stand_to_world[:3, 3] = head_to_world[:3, :3] @ self._head_base + head_to_world[:3, 3]
        self._collision.set_head_pose(head_to_world)
        self._contact.head_has_moved()
        self._posture = self._postures.of(self._contact.at(q or self._start))
        self._proximity = Proximity.FREE
        self._pressing = Pressing()
        self._is_within_reach = True
        self._obstacle = ""
        self._operator = ""
        self._teleoperation.stop()
        self._view.planned_target = None

    def _move(self, dt: float, wish: Wish, sim_time: float) -> list[Event]:
        """Follow the wish as far as arm, head and table allow."""
        before = self._is_within_reach, self._obstacle
        tip = self._posture.tip.position
        moved = self._moved(dt, wish)
        if moved.stopped_by in BEHIND_THE_TOOL and wish.direction is not None:
            # The turn of the tool may be what the arm has no room for: the tip comes first.
            moved = self._moved(dt, replace(wish, direction=None, across=None))
        self._posture = self._postures.of(moved)
        settings = self.setup.settings.proximity
        self._proximity = next_proximity(self._proximity, moved.clearance, settings)
        self._press(wish, tip)
        self._obstacle = moved.stopped_by if moved.stopped_by in BEHIND_THE_TOOL else ""
        if before == (self._is_within_reach, self._obstacle):
            return []
        data = {"isWithinReach": self._is_within_reach, "obstacle": self._obstacle}
        return [Event(EventKind.REACH, sim_time, data)]

    def _press(self, wish: Wish, before: Vector) -> None:
        """Measure how far the tool is pressed in after a motion of the tip from `before`."""
        if self._proximity is not Proximity.CONTACT:
            self._pressing.end()
            return
        tip, clearance = self._posture.tip.position, self._posture.clearance
        to_goal = None if wish.goal is None else subtract(wish.goal, tip)
        self._pressing.move(wish.displacement, subtract(tip, before), clearance, to_goal)

    def _moved(self, dt: float, wish: Wish) -> Moved:
        q, tip = self._posture.q, self._posture.tip.position

        def to_joints(allowed: Vector) -> Joints:
            joints, self._is_within_reach = self._joint_motion.toward(
                q, tip, allowed, wish.direction, dt, wish.across
            )
            return joints

        return self._contact.move(q, wish.displacement, to_joints)

    def _state(self, tick: int, sim_time: float, motion: Motion) -> SimulationState:
        posture = self._posture
        return SimulationState(
            tick=tick,
            sim_time=sim_time,
            q=posture.q,
            tool_tip_to_world=posture.tool_tip_to_world,
            link_to_world=posture.links,
            head_to_world=self._head_to_world,
            stand_to_world=self._stand_to_world,
            proximity=self._proximity,
            clearance=posture.clearance.tool_m,
            training=self._training.state,
            elapsed=self._training.elapsed(sim_time),
            motion=motion,
            operator=self._operator,
            camera=self._view.camera,
            planned_target=self._view.planned_target,
            depth=self._pressing.depth,
        )


def _collision(setup: SimulationSetup, head: HeadMesh) -> Collision:
    surroundings = Surroundings(stand_radius=setup.scenario.furniture.stand_diameter / 2.0 / MM)
    return Collision(setup.shape, head.vertices / MM, head.triangles, surroundings)


def _ended(outcome: Outcome, sim_time: float) -> Event:
    return Event(EventKind.MOTION, sim_time, {"outcome": outcome.value})


def _proximity(
    before: Proximity, state: SimulationState, pressing: Pressing, sim_time: float
) -> Event:
    data: dict[str, Any] = {
        "from": before.value,
        "to": state.proximity.value,
        "clearanceMm": MM * state.clearance,
    }
    if before is Proximity.CONTACT:
        data["depthMm"] = MM * pressing.deepest
    return Event(EventKind.PROXIMITY, sim_time, data)
