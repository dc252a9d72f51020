"""A procedure tick by tick: the guide is steered and aligned, drill and instrument are fed."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.head.mesh import read_head_mesh
from rastrainer.journal import entries
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.state import Motion, OperatorInput
from rastrainer_simulator.trial_state import Tool
from Testing.simulator.core.test_simulation import Driver
from Testing.simulator.planned_procedures import INNER_MM, OUTER_MM

SEED = 4
IDENTITY = Rotation.identity()
RIGHT = OperatorInput(translation=(1.0, 0.0, 0.0), operator="gamepad")
TURN = OperatorInput(rotation=(1.0, 0.0), operator="gamepad")
IN = OperatorInput(translation=(0.0, 0.0, -1.0), operator="gamepad")
OUT = OperatorInput(translation=(0.0, 0.0, 1.0), operator="gamepad")


class Surgeon(Driver):
    """Carries out a procedure on a simulation."""

    def must(self, command, **arguments):
        answer = self.do(command, **arguments)
        assert answer.ok, answer.message
        return answer

    @property
    def exact(self):
        """The true registration, (4, 4) float, mm."""
        return transforms.inverse(self.simulation.truth.head_to_world)

    def to(self, phase, procedure="dbs", shift_mm=(0.0, 0.0, 0.0), turn=IDENTITY):
        """Begin a trial and go to a phase of its procedure, by a registration with an offset."""
        self.do(CommandName.ABORT)
        start = {"task": "task-1", "trainee": "P01", "seed": SEED, "procedure": procedure}
        self.must(CommandName.START_TASK, **start)
        for _ in range(15):
            self.must(CommandName.CAPTURE)
        self.must(CommandName.REGISTER)
        registration = self.exact
        registration[:3, :3] = turn.as_matrix() @ registration[:3, :3]
        registration[:3, 3] = turn.apply(registration[:3, 3]) + shift_mm
        self.must(
            CommandName.USE_REGISTRATION,
            trialId=self.state.training.trial_id,
            matrix=registration.ravel().tolist(),
            freMm=1.0,
            expectedTreMm=1.0,
        )
        if phase is not Phase.VERIFYING:
            self.must(CommandName.ACCEPT_REGISTRATION)
        if phase in (Phase.DRILLING, Phase.INSERTING):
            assert self.align() == "reached"
            self.must(CommandName.LOCK_GUIDE)
        if phase is Phase.INSERTING:
            self.feed(self.through + 0.002, IN)
            self.must(CommandName.START_INSERTION)
        self.events.clear()

    def align(self, stand_off_mm=30.0):
        """Have the robot align the guide; return how its motion ended."""
        self.must(CommandName.ALIGN_GUIDE, standOffMm=stand_off_mm)
        while self.state.motion is not Motion.NONE:
            self.step()
        return [e.entry.outcome for e in self.events if isinstance(e.entry, entries.MotionEnd)][-1]

    @property
    def through(self):
        """Where the axis leaves the bone, beyond the guide's tip, m."""
        return self.simulation._procedure_motion.feed.ahead.inner

    def feed(self, depth, sticks):
        """Hold the stick until the feed is at a depth, m."""
        sign = -sticks.translation[2]
        self.until(sticks, lambda state: sign * (state.feed - depth) >= 0.0, 30_000)


@pytest.fixture(scope="module")
def shared_procedure(planned):
    return Simulation(planned, SEED)


@pytest.fixture
def surgeon(shared_procedure):
    return Surgeon(shared_procedure)


def test_while_aligning_the_second_stick_turns_the_guide_and_the_first_keeps_its_direction(surgeon):
    """The setting leaves the direction free elsewhere."""
    surgeon.to(Phase.ALIGNING)
    axis = surgeon.state.guide_axis.direction
    for _ in range(100):
        surgeon.step(RIGHT)
    assert surgeon.state.guide_axis.direction == pytest.approx(axis, abs=1e-9)
    tip = surgeon.tip
    for _ in range(50):
        surgeon.step(TURN)
    turned = np.degrees(np.arccos(np.dot(surgeon.state.guide_axis.direction, axis)))
    assert turned == pytest.approx(np.degrees(0.8 * 50 * 0.004), rel=0.02)
    np.testing.assert_allclose(surgeon.tip, tip, atol=1e-6)


def test_the_robot_aligns_the_guide_with_the_plan_as_registered(surgeon):
    shift_mm = (2.0, -1.0, 1.0)
    surgeon.to(Phase.ALIGNING, shift_mm=shift_mm)
    assert surgeon.align(stand_off_mm=20.0) == "reached"
    shown = surgeon.state.alignment
    assert MM_PER_M * shown.entry_distance <= 0.05
    assert np.degrees(shown.angle) <= 0.05
    assert MM_PER_M * shown.stand_off == pytest.approx(20.0, abs=0.05)
    # The error of the registration goes into the patient.
    axis = surgeon.state.guide_axis
    planned = surgeon.simulation.setup.scenario.procedure("dbs").trajectories[0].entry_ras
    true_entry = surgeon.simulation.truth.in_world(planned) / MM_PER_M
    to_entry = true_entry - axis.tip
    aside = to_entry - np.dot(to_entry, axis.direction) * np.array(axis.direction)
    world_shift = surgeon.simulation.truth.head_to_world[:3, :3] @ np.array(shift_mm)
    expected = world_shift - np.dot(world_shift, axis.direction) * np.array(axis.direction)
    np.testing.assert_allclose(MM_PER_M * aside, expected, atol=0.01)


def test_a_guide_that_hands_moved_off_after_the_robot_counts_as_aligned_by_the_robot(surgeon):
    surgeon.to(Phase.ALIGNING)
    assert surgeon.align() == "reached"
    for _ in range(20):
        surgeon.step(RIGHT)
    assert not surgeon.state.alignment.is_exact
    surgeon.must(CommandName.LOCK_GUIDE)
    assert surgeon.state.training.procedure.present.is_self_aligned


def test_the_robot_does_not_align_the_guide_where_the_setting_forbids_it(planned):
    procedure = replace(planned.settings.procedure, self_alignment=False)
    setup = replace(planned, settings=replace(planned.settings, procedure=procedure))
    surgeon = Surgeon(Simulation(setup, SEED))
    surgeon.to(Phase.ALIGNING)
    answer = surgeon.do(CommandName.ALIGN_GUIDE)
    assert "does not align the guide by itself" in answer.message
    assert surgeon.state.motion is Motion.NONE


def test_a_line_on_which_the_robot_cannot_hold_the_guide_is_refused_at_once(surgeon):
    # This registration puts the head half a meter farther away.
    surgeon.to(Phase.ALIGNING, shift_mm=(500.0, 0.0, 0.0))
    answer = surgeon.do(CommandName.ALIGN_GUIDE, standOffMm=30.0)
    assert "with a stand-off of 30 mm" in answer.message
    assert surgeon.state.motion is Motion.NONE


def test_the_distances_ahead_are_those_of_the_true_surfaces(surgeon):
    surgeon.to(Phase.DRILLING, shift_mm=(1.0, 2.0, 0.0))
    scenario = surgeon.simulation.setup.scenario
    ahead = surgeon.simulation._procedure_motion.feed.ahead
    axis = surgeon.state.guide_axis

    def in_head(depth):
        return surgeon.simulation.truth.in_head(
            MM_PER_M * (np.array(axis.tip) + depth * np.array(axis.direction))
        )

    for depth, radius in ((ahead.outer, OUTER_MM), (ahead.inner, INNER_MM)):
        away = np.linalg.norm(in_head(depth) - scenario.target.position_ras)
        # The made-up skull is a polyhedron in these spheres.
        assert radius - 0.5 <= away <= radius
    skin = read_head_mesh(scenario.head)
    nearest = np.linalg.norm(skin.vertices - in_head(ahead.skin), axis=1).min()
    assert nearest < 3.0
    assert 0.0 < ahead.skin < ahead.outer < ahead.inner


def test_a_locked_guide_does_not_move_whatever_the_sticks_and_commands_request(surgeon):
    surgeon.to(Phase.INSERTING)
    before = surgeon.state
    for _ in range(100):
        surgeon.step(replace(RIGHT, rotation=(1.0, -1.0)))
        assert surgeon.state.q == before.q
    for command, arguments in (
        (CommandName.JOG, {"velocityMmS": [0, 0, 50]}),
        (CommandName.MOVE_TIP_TO, {"positionMm": [500, 0, 400]}),
        (CommandName.ALIGN_GUIDE, {}),
    ):
        assert "arm is held" in surgeon.do(command, **arguments).message
    assert surgeon.state.q == before.q


def test_the_drill_follows_the_stick_through_skin_and_bone_and_reports_what_is_felt(surgeon):
    surgeon.to(Phase.DRILLING)
    ahead = surgeon.simulation._procedure_motion.feed.ahead
    surgeon.feed(ahead.inner + 0.001, IN)
    felt = [e.entry for e in surgeon.events if isinstance(e.entry, entries.FeedChange)]
    assert [each.layer for each in felt] == ["scalp", "bone", "through"]
    for each, depth in zip(felt, (ahead.skin, ahead.outer, ahead.inner), strict=True):
        assert each.feed_mm == pytest.approx(MM_PER_M * depth, abs=0.02)
    assert surgeon.state.motion is Motion.FEED
    assert surgeon.state.operator == "gamepad"
    depth = surgeon.state.feed
    surgeon.step()
    assert surgeon.state.motion is Motion.NONE
    assert surgeon.state.feed == depth


def test_a_drill_in_the_scalp_can_be_retracted_and_the_guide_aligned_again(surgeon):
    surgeon.to(Phase.DRILLING)
    surgeon.feed(surgeon.simulation._procedure_motion.feed.ahead.skin + 0.001, IN)
    surgeon.must(CommandName.RETRACT_DRILL)
    assert (surgeon.state.tool, surgeon.state.feed) == (Tool.GUIDE, 0.0)
    surgeon.must(CommandName.LOCK_GUIDE)
    assert surgeon.state.training.procedure.present.alignments == 2
    surgeon.feed(surgeon.through - 0.004, IN)
    assert "has cut bone" in surgeon.do(CommandName.RETRACT_DRILL).message


def test_the_instruments_place_is_on_the_guides_axis_and_an_abort_leaves_nothing(surgeon):
    surgeon.to(Phase.INSERTING)
    surgeon.feed(0.08, IN)
    surgeon.must(CommandName.RELEASE_INSTRUMENT)
    placed = surgeon.state.training.procedure.trajectories[0]
    assert placed.instrument_depth == pytest.approx(0.08, abs=5e-5)
    assert placed.guide == surgeon.state.guide_axis
    assert placed.drill_depth >= surgeon.state.feed == 0.0
    assert surgeon.state.plan_in_world.name == "Line 1"
    surgeon.must(CommandName.ABORT)
    assert (surgeon.state.tool, surgeon.state.feed) == (Tool.POINTER, 0.0)


def test_a_commanded_feed_goes_the_commanded_distance(surgeon):
    surgeon.to(Phase.DRILLING)
    surgeon.must(CommandName.FEED, velocityMmS=2.0, durationS=0.5)
    for _ in range(200):
        surgeon.step()
    assert MM_PER_M * surgeon.state.feed == pytest.approx(1.0)
