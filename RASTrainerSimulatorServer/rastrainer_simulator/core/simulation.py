"""One tick of everything: input, trial, motion, contact, state. No clock, no socket, no file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.head.mesh import read_head_mesh
from rastrainer.journal import entries
from rastrainer.journal.entries import StartingPoint
from rastrainer.protocol import Phase, Proximity
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.collision import head_collision, stand_pose
from rastrainer_simulator.collision.contact import Contact, Moved
from rastrainer_simulator.collision.proximity import Pressing, next_proximity
from rastrainer_simulator.collision.touch_planner import PlanReach
from rastrainer_simulator.core.arm import JointMotion, Joints, start_joints
from rastrainer_simulator.core.procedure_motion import FEED_PHASES, ProcedureMotion
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.state import (
    Answer,
    Event,
    Motion,
    OperatorCommand,
    OperatorInput,
    PlanInWorld,
    SimulationState,
    StepResult,
)
from rastrainer_simulator.teleoperation.commanded_motion import (
    CommandedMotion,
    MotionOutcome,
    commanded_motion,
)
from rastrainer_simulator.teleoperation.steering import (
    ROBOT_AXES,
    Axes,
    AxesChoice,
    NearestSurface,
    axes_of,
)
from rastrainer_simulator.teleoperation.teleoperation import MotionRequest, Teleoperation, Tip
from rastrainer_simulator.training.feed import Feed
from rastrainer_simulator.training.head_pose import Truth
from rastrainer_simulator.training.replies import TrainingReply
from rastrainer_simulator.training.rules import TouchMoment, refusal, touch_stage
from rastrainer_simulator.training.training import Training
from rastrainer_simulator.trial_state import GuideAxis
from rastrainer_simulator.vectors import Vector, in_meters, subtract

if TYPE_CHECKING:
    from rastrainer_simulator.core.interrupted_trial import InterruptedTrial

BEHIND_THE_TOOL = ("links", "self", "table")
"""Parts of the arm that the trainee does not steer directly but that may collide."""


class Simulation:
    """The robot, the head and the trial.

    `step` is deterministic: the same setup, seed and inputs give the same states to the last bit.
    A trial always starts with the arm above the head and keeps nothing from before: a replay needs
    only the trial's own inputs.
    """

    def __init__(self, setup: SimulationSetup, seed: int) -> None:
        """Build the scene; takes about a second, most of it for the head's surface."""
        settings = setup.settings
        self.setup = setup
        self._training = Training(setup.scenario, seed, settings.training, settings.procedure)
        self._camera = settings.camera
        cameras = setup.scenario.cameras
        self._camera_axes = {name: axes_of(camera) for name, camera in cameras.items()}
        self._planned_target: PlanInWorld | None = None
        self._teleoperation = Teleoperation(settings.teleoperation)
        head = read_head_mesh(setup.scenario.head)
        self._head_base = head.base / MM_PER_M
        self._collision = head_collision(setup.shape, head, setup.scenario)
        kinematics = make_kinematics(setup.robot)
        self.kinematics_name = type(kinematics).__name__
        self._contact = Contact(self._collision, kinematics)
        self._plan_reach = PlanReach(setup.robot, kinematics, self._collision)
        self._procedure_motion = ProcedureMotion(setup, head, self._plan_reach)
        self.planned_bone = self._procedure_motion.planned_bone
        self._tip_name = setup.robot.tip.name
        self._link_names = tuple(link.name for link in setup.robot.moving_links)
        self._start = start_joints(setup.robot, setup.scenario, settings.start_height)
        self._joint_motion = JointMotion(setup.robot, self._start, settings.fabrik)
        self._put_in_place()
        self.state = self._state(0, 0.0, Motion.NONE)

    @property
    def truth(self) -> Truth:
        """True pose of the head. Hidden from clients until the trial is scored."""
        return self._training.truth

    @property
    def trial_seed(self) -> int:
        """The seed of the head's pose in the present trial: as secret as the pose."""
        return self._training.trial_seed

    def restart_from(self, point: StartingPoint) -> None:
        """Continue ticks, time and revisions of another simulation, before the first step."""
        self._training.restart_from(point.revision)
        self._camera = point.camera or self._camera
        self.state = self._state(point.tick, point.sim_time_s, Motion.NONE)

    def resume_trial(
        self, interrupted: InterruptedTrial, point: StartingPoint | None = None
    ) -> None:
        """Resume a trial of a journal before the next step, with the arm as in its last sample.

        Ticks, time and view continue from `point`, by default from the journal's last line.
        """
        point = point or interrupted.point
        self._training.resume_trial(interrupted.revision_before, interrupted.steps)
        self._put_in_place(interrupted.q)
        self._proximity = interrupted.proximity
        self._is_within_reach = interrupted.reach.is_within_reach
        self._obstacle = interrupted.reach.obstacle
        self._procedure_motion.reset(interrupted.feed)
        self._camera = point.camera or self._camera
        self.state = self._state(point.tick, point.sim_time_s, Motion.NONE)

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
            if reply.feed is not None:
                self._procedure_motion.reset(reply.feed)
        proximity = self._proximity
        motion_request = self._motion_request(dt, operator_input)
        sim_time = before.sim_time + dt
        if motion_request.ended is not None:
            events.append(Event(sim_time, entries.MotionEnd(motion_request.ended.value)))
        if motion_request.motion is not Motion.NONE:
            events.extend(self._move(dt, motion_request, sim_time))
            if motion_request.motion is Motion.STICK:
                self._operator = operator_input.operator
        self._training.end_refusal(sim_time)
        events.extend(self._training.trace(self._touch_moment(sim_time)))
        fed = self._procedure_motion.step(dt, self._training.state.phase, operator_input, sim_time)
        events.extend(fed.events)
        if fed.is_by_stick:
            self._operator = operator_input.operator
        motion = Motion.FEED if fed.has_moved else motion_request.motion
        self.state = self._state(before.tick + 1, sim_time, motion)
        if self._proximity is not proximity:
            was_contact = proximity is Proximity.CONTACT
            change = entries.ProximityChange(
                from_=proximity,
                to=self._proximity,
                clearance_mm=MM_PER_M * self.state.clearance,
                depth_mm=MM_PER_M * self._pressing.deepest if was_contact else None,
            )
            events.append(Event(sim_time, change))
        return StepResult(self.state, tuple(events), tuple(answers))

    def _carry_out(self, command: OperatorCommand, sim_time: float) -> TrainingReply:
        if command.name in self._training.handlers:
            return self._training.handle(command, self._moment_of(command, sim_time))
        sentence = refusal(command, self._training.state)
        if sentence is not None:
            return TrainingReply(False, sentence)
        arguments = command.arguments
        if command.name == CommandName.LIST_TASKS:
            return TrainingReply(True, data=listed(self.setup.scenario))
        if command.name == CommandName.SET_CAMERA:
            self._camera = arguments["camera"]
            event = Event(sim_time, entries.CameraChange(arguments["camera"]))
            return TrainingReply(True, events=(event,))
        if command.name == CommandName.PLAN_TARGET:
            return self._plan(arguments)
        if command.name == CommandName.FEED:
            self._procedure_motion.drive.start(arguments["velocityMmS"], arguments["durationS"])
            self._operator = command.sender
            return TrainingReply(True)
        motion: CommandedMotion | str
        if command.name == CommandName.ALIGN_GUIDE:
            procedure = self._training.state.procedure
            motion = self._procedure_motion.way(
                self._guide_axis, procedure, arguments["standOffMm"]
            )
        else:
            x, y, z, _ = self._tool_tip_to_world.T.tolist()
            tool = Axes(tuple(x[:3]), tuple(y[:3]), tuple(z[:3]))
            motion = commanded_motion(command, self._camera_axes[self._camera], tool)
        if isinstance(motion, str):
            return TrainingReply(False, motion)
        if command.name == CommandName.ALIGN_GUIDE:
            self._training.note_self_alignment()
        self._teleoperation.start(motion)
        self._operator = command.sender
        return TrainingReply(True)

    def _plan(self, arguments: Mapping[str, Any]) -> TrainingReply:
        """Show a planned target, and answer whether the robot can reach it."""
        position, entry = in_meters(arguments["positionMm"]), arguments["entryMm"]
        entry = None if entry is None else in_meters(entry)
        answer = self._plan_reach.judge(position, entry)
        self._planned_target = PlanInWorld(arguments["name"], position, entry, answer.reachable)
        return TrainingReply(True, data=answer._asdict())

    def _motion_request(self, dt: float, operator_input: OperatorInput) -> MotionRequest:
        """Return the requested motion; none while the trial is paused or the guide locked."""
        phase = self._training.state.phase
        if phase is Phase.PAUSED:
            self._procedure_motion.drive.stop()
        if phase is Phase.PAUSED or phase in FEED_PHASES:
            stopped = self._teleoperation.stop()
            return MotionRequest(Motion.NONE, ended=MotionOutcome.STOPPED if stopped else None)
        self._teleoperation.steering.hold_direction(phase is Phase.ALIGNING)
        is_by_robot = self.setup.settings.axes is AxesChoice.ROBOT
        axes = ROBOT_AXES if is_by_robot else self._camera_axes[self._camera]
        tip = self._moved.clearance.tip
        # A shaft that is far is no nearer than the tip, and then the tip alone counts.
        shaft = self._moved.clearance.shaft or tip
        surface = NearestSurface(tip.distance_m, tip.normal, shaft.distance_m, shaft.normal)
        return self._teleoperation.step(dt, operator_input, self._tip, axes, surface)

    def _put_in_place(self, q: Joints | None = None) -> None:
        """Put the head where the trial has it, and the arm where trials start, or at `q`."""
        self._placed = self._training.truth
        self._head_to_world = head_to_world = transforms.in_meters(self._placed.head_to_world)
        self._stand_to_world = stand_pose(head_to_world, self._head_base)
        self._collision.set_head_pose(head_to_world)
        self._contact.head_has_moved()
        self._place(self._contact.at(q or self._start))
        self._proximity = Proximity.FREE
        self._pressing = Pressing()
        self._is_within_reach = True
        self._obstacle = ""
        self._operator = ""
        self._teleoperation.stop()
        self._procedure_motion.reset()
        self._planned_target = None

    def _place(self, moved: Moved) -> None:
        self._moved = moved
        poses = moved.link_to_world
        self._link_to_world = tuple(poses[name] for name in self._link_names)
        self._tool_tip_to_world = poses[self._tip_name]
        (ax, _, dx, x), (ay, _, dy, y), (az, _, dz, z), _ = self._tool_tip_to_world.tolist()
        self._tip = Tip((x, y, z), (dx, dy, dz), (ax, ay, az))

    def _move(self, dt: float, motion_request: MotionRequest, sim_time: float) -> list[Event]:
        """Carry out a request as far as arm, head and table allow."""
        before = self._is_within_reach, self._obstacle
        tip = self._tip.position
        moved = self._reached(dt, motion_request)
        if moved.stopped_by in BEHIND_THE_TOOL and motion_request.direction is not None:
            # The arm may only lack room to turn the tool: the tip comes first.
            moved = self._reached(dt, replace(motion_request, direction=None, across=None))
        self._place(moved)
        settings = self.setup.settings.proximity
        self._proximity = next_proximity(self._proximity, moved.clearance, settings)
        if self._proximity is Proximity.CONTACT:
            after, goal = self._tip.position, motion_request.goal
            to_goal = None if goal is None else subtract(goal, after)
            pushed = motion_request.displacement
            self._pressing.move(pushed, subtract(after, tip), moved.clearance, to_goal)
        else:
            self._pressing.end()
        self._obstacle = moved.stopped_by if moved.stopped_by in BEHIND_THE_TOOL else ""
        if before == (self._is_within_reach, self._obstacle):
            return []
        return [Event(sim_time, entries.Reach(self._is_within_reach, self._obstacle))]

    def _reached(self, dt: float, motion_request: MotionRequest) -> Moved:
        q, tip = self._moved.q, self._tip.position

        def to_joints(allowed: Vector) -> Joints:
            joints, self._is_within_reach = self._joint_motion.toward(
                q, tip, allowed, motion_request.direction, dt, motion_request.across
            )
            return joints

        return self._contact.move(q, motion_request.displacement, to_joints)

    def _state(self, tick: int, sim_time: float, motion: Motion) -> SimulationState:
        clearance, training = self._moved.clearance, self._training.state
        moment, goal = self._touch_moment(sim_time), self._training.goal_of(self._training.state)
        settings = self.setup.settings.training
        return SimulationState(
            tick=tick,
            sim_time=sim_time,
            q=self._moved.q,
            tool_tip_to_world=self._tool_tip_to_world,
            link_to_world=self._link_to_world,
            head_to_world=self._head_to_world,
            stand_to_world=self._stand_to_world,
            proximity=self._proximity,
            clearance=clearance.tool_m,
            training=training,
            elapsed=self._training.elapsed(sim_time),
            motion=motion,
            operator=self._operator,
            camera=self._camera,
            planned_target=self._planned_target,
            depth=self._pressing.depth,
            touch=touch_stage(moment, self._proximity, self._obstacle, training, goal, settings),
            feed=self._procedure_motion.feed.depth,
            tip_clearance=clearance.tip_m,
        )

    @property
    def _guide_axis(self) -> GuideAxis:
        return GuideAxis(self._tip.position, self._tip.direction)

    def _moment_of(self, command: OperatorCommand, sim_time: float) -> TouchMoment:
        feed = self._procedure_motion.feed
        if command.name == CommandName.LOCK_GUIDE and self._training.state.phase is Phase.ALIGNING:
            ahead = self._procedure_motion.ahead(self._guide_axis, self._head_to_world)
            feed = Feed(ahead=ahead)
        moment = self._touch_moment(sim_time)
        return replace(moment, direction=self._guide_axis.direction, feed=feed)

    def _touch_moment(self, sim_time: float) -> TouchMoment:
        above = self._moved.clearance.tip_m
        return TouchMoment(sim_time, self._tip.position, above, self._pressing.depth)


def listed(scenario: Scenario) -> dict[str, Any]:
    return {
        "scenario": scenario.name,
        "title": scenario.title,
        "tasks": [
            {"name": task.name, "title": task.title, "complexity": task.complexity}
            for task in scenario.tasks
        ],
        "procedures": [
            {
                "name": procedure.name,
                "title": procedure.title,
                "kind": procedure.kind.value,
                "trajectories": [trajectory.name for trajectory in procedure.trajectories],
            }
            for procedure in scenario.procedures
        ],
    }
