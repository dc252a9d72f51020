"""The simulation tick by tick: deterministic, stopped by the head, ready for a trial."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.journal import entries
from rastrainer.protocol import Phase, Proximity, TouchRule
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.state import (
    NEUTRAL_STICKS,
    Motion,
    OperatorCommand,
    OperatorInput,
)
from rastrainer_simulator.teleoperation.steering import (
    camera_axes,
)

DT = 0.004
DOWN = OperatorInput(translation=(0.0, 0.0, -1.0))
SEED = 12


class Driver:
    """Steps a simulation and remembers what happened."""

    def __init__(self, simulation):
        self.simulation = simulation
        self.events = []

    @property
    def state(self):
        return self.simulation.state

    @property
    def tip(self):
        return self.state.tool_tip_to_world[:3, 3].copy()

    def step(self, operator_input=NEUTRAL_STICKS):
        result = self.simulation.step(DT, operator_input)
        self.events.extend(result.events)
        return result

    def do(self, command, **arguments):
        command = OperatorCommand(command, check_arguments(command, arguments), sender="tester")
        return self.step(OperatorInput(commands=(command,))).answers[0]

    def start(self, task="task-1", seed=SEED):
        return self.do(CommandName.START_TASK, task=task, trainee="P01", seed=seed)

    def outcomes(self):
        return [e.entry.outcome for e in self.events if isinstance(e.entry, entries.MotionEnd)]

    def move_to(self, position_mm, speed=500.0, most_ticks=2500):
        self.do(CommandName.MOVE_TIP_TO, positionMm=list(position_mm), speedMmS=speed)
        for _ in range(most_ticks):
            if self.state.motion is Motion.NONE:
                return self.outcomes()[-1]
            self.step()
        raise AssertionError("the move never ended")

    def until(self, operator_input, reached, most_ticks=2500):
        for _ in range(most_ticks):
            self.step(operator_input)
            if reached(self.state):
                return
        raise AssertionError("never reached")


@pytest.fixture(scope="module")
def shared(setup):
    return Simulation(setup, SEED)


@pytest.fixture
def idle(shared):
    """Return the shared simulation between two trials, with the arm where trials start."""
    driver = Driver(shared)
    if shared.state.training.phase in (Phase.REGISTERED, Phase.SCORED, Phase.IDLE):
        driver.start()
    driver.do(CommandName.ABORT)
    driver.events.clear()
    return driver


@pytest.fixture
def trial(idle):
    idle.start()
    idle.events.clear()
    return idle


def random_inputs(seed, ticks, down=(0.0, 0.0, -1.0)):
    random = np.random.default_rng(seed)
    stick = NEUTRAL_STICKS
    for tick in range(ticks):
        if tick % 60 == 0:
            translation = tuple(random.uniform(-0.6, 0.6, 3) + down)
            stick = OperatorInput(translation, tuple(random.uniform(-1, 1, 2)), tick % 420 == 360)
        yield stick


def trajectory(driver, inputs):
    return [
        (state.q, state.tool_tip_to_world.tobytes(), state.clearance, state.proximity)
        for state in (driver.step(operator_input).state for operator_input in inputs)
    ]


def test_the_same_seed_and_inputs_give_the_same_states_to_the_last_bit(setup, trial):
    other = Driver(Simulation(setup, SEED))
    other.start()
    first = trajectory(trial, random_inputs(1, 500))
    second = trajectory(other, random_inputs(1, 500))
    assert first == second
    assert {proximity for *_, proximity in first} == set(Proximity)


def test_a_trial_does_not_depend_on_what_was_done_before_it(trial):
    first = trajectory(trial, random_inputs(2, 300))
    trial.do(CommandName.ABORT)
    trajectory(trial, random_inputs(3, 300))
    trial.do(CommandName.JOG, velocityMmS=[0, 0, 50], durationS=2.0)
    trial.start()
    assert trajectory(trial, random_inputs(2, 300)) == first


def test_the_start_pose_is_clear_of_the_head_for_every_seed(idle):
    for seed in range(8):
        idle.start(seed=seed)
        assert idle.state.clearance > 0.05
        assert idle.state.proximity is Proximity.FREE
        idle.do(CommandName.ABORT)


def test_the_tip_goes_where_the_stick_points_and_no_joint_is_ever_too_fast(trial, setup):
    limits = np.array(setup.robot.velocity) * DT * (1 + 1e-9)
    lower, upper = setup.robot.limits
    for operator_input in random_inputs(4, 600):
        before = np.array(trial.state.q)
        trial.step(operator_input)
        q = np.array(trial.state.q)
        assert (np.abs(q - before) <= limits).all()
        assert ((lower <= q) & (q <= upper)).all()


def axes_of_the_camera(scenario):
    view = scenario.cameras["close-up"]
    return camera_axes(tuple(view.focal_point_mm - view.position_mm), tuple(view.view_up))


def test_the_tip_moves_right_when_the_stick_is_pushed_right(trial, scenario):
    start = trial.tip
    for _ in range(100):
        trial.step(OperatorInput(translation=(1.0, 0.0, 0.0), operator="gamepad"))
    moved = trial.tip - start
    right = axes_of_the_camera(scenario).right
    assert moved @ right == pytest.approx(np.linalg.norm(moved), rel=1e-6)
    assert np.linalg.norm(moved) > 0.03
    assert trial.state.operator == "gamepad"
    assert trial.state.motion is Motion.STICK
    stopped = trial.step().state
    assert stopped.motion is Motion.NONE
    for _ in range(20):
        assert trial.step().state.q == stopped.q


def test_the_tool_cannot_be_driven_into_the_head_and_slides_along_it(trial):
    trial.until(DOWN, lambda state: state.proximity is Proximity.CONTACT)
    deepest = 0.0
    touched = trial.tip
    for tick in range(400):
        push = OperatorInput(translation=(0.6 * math.sin(tick / 50), 0.0, -1.0))
        deepest = min(deepest, trial.step(push).state.clearance)
    assert deepest >= -0.0001
    assert np.linalg.norm(trial.tip - touched) > 0.005


def test_a_move_reaches_its_target_and_reports_it(trial):
    target = MM_PER_M * trial.tip + (10.0, -30.0, 15.0)
    assert trial.move_to(target) == "reached"
    assert MM_PER_M * trial.tip == pytest.approx(target, abs=0.001)
    center = trial.simulation.truth.in_world(trial.simulation.truth.target_ras)
    assert trial.move_to(center) == "blocked"
    assert trial.state.clearance >= -0.0001
    assert trial.state.proximity is Proximity.CONTACT


@pytest.mark.parametrize("frame", ["world", "camera", "tool"])
def test_a_jog_moves_along_the_axes_of_its_frame(trial, scenario, frame):
    camera = axes_of_the_camera(scenario)
    axes = {
        "world": np.eye(3),
        "camera": np.array([camera.right, camera.forward, camera.up]),
        "tool": trial.state.tool_tip_to_world[:3, :3].T,
    }[frame]
    start = trial.tip
    trial.do(CommandName.JOG, velocityMmS=[0.0, -40.0, 0.0], frame=frame, durationS=0.5)
    trial.until(NEUTRAL_STICKS, lambda state: state.motion is Motion.NONE)
    moved = trial.tip - start
    assert moved / np.linalg.norm(moved) == pytest.approx(-axes[1], abs=1e-3)
    assert np.linalg.norm(moved) == pytest.approx(0.04 * 0.5, rel=0.05)


def test_while_the_trial_is_paused_the_arm_does_not_move_and_motions_are_refused(trial):
    trial.do(CommandName.MOVE_TIP_TO, positionMm=list(MM_PER_M * trial.tip + (0.0, 0.0, 50.0)))
    trial.step()
    trial.do(CommandName.PAUSE)
    q, elapsed = trial.state.q, trial.state.elapsed
    for _ in range(20):
        trial.step(OperatorInput(translation=(1.0, 0.0, 0.0)))
    assert trial.state.q == q
    assert trial.state.elapsed == elapsed
    assert "resume it first" in trial.do(CommandName.JOG, velocityMmS=[1, 0, 0]).message
    assert trial.outcomes() == ["stopped"]


def test_a_planned_target_is_shown_once_the_trial_is_registered(setup):
    anywhere = replace(
        setup.settings.training, acceptance_radius=10.0, touch_rule=TouchRule.WITHIN_RADIUS
    )
    driver = Driver(
        Simulation(replace(setup, settings=replace(setup.settings, training=anywhere)), 1)
    )
    driver.start()
    plan = {"positionMm": [500.0, 0.0, 300.0], "name": "tumor"}
    assert "not registered yet" in driver.do(CommandName.PLAN_TARGET, **plan).message
    for _ in range(15):
        driver.do(CommandName.CAPTURE)
    driver.do(CommandName.REGISTER)
    assert driver.do(CommandName.PLAN_TARGET, **plan).data == {"reachable": True, "reason": ""}
    assert driver.state.planned_target.name == "tumor"
    assert driver.state.planned_target.position == (0.5, 0.0, 0.3)
    steep = driver.do(CommandName.PLAN_TARGET, **plan, entryMm=[500.0, 0.0, 360.0])
    assert steep.data["reachable"]
    assert driver.state.planned_target.entry == (0.5, 0.0, 0.36)
    below = driver.do(CommandName.PLAN_TARGET, **plan, entryMm=[500.0, 0.0, 150.0])
    assert "along the whole trajectory" in below.data["reason"]
    far = driver.do(CommandName.PLAN_TARGET, positionMm=[2000.0, 0.0, 300.0])
    assert far.data == {"reachable": False, "reason": "The target is out of the robot's reach."}
    assert not driver.state.planned_target.reachable
    driver.start()
    assert driver.state.planned_target is None
