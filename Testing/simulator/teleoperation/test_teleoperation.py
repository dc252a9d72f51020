"""The sticks and commanded motions as the trainee feels them."""

import pytest

from rastrainer_simulator.state import NEUTRAL_STICKS, Motion, OperatorInput
from rastrainer_simulator.teleoperation.commanded_motion import (
    ARRIVED,
    MotionOutcome,
    Moving,
)
from rastrainer_simulator.teleoperation.steering import (
    NearestSurface,
    SteeringSettings,
    ToolDirection,
    camera_axes,
)
from rastrainer_simulator.teleoperation.teleoperation import (
    StickResponse,
    Teleoperation,
    TeleoperationSettings,
    Tip,
)
from rastrainer_simulator.vectors import ZERO, add, angle, distance, dot, length, unit

DT = 0.004
DOWN = (0.0, 0.0, -1.0)
RIGHT = (1.0, 0.0, 0.0)
FRONT_CAMERA = camera_axes((0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
SETTINGS = TeleoperationSettings()


class Hand:
    """A tip that goes exactly where it is sent: teleoperation without a robot."""

    def __init__(self, settings=SETTINGS, axes=FRONT_CAMERA, surface=None):
        self.teleoperation = Teleoperation(settings)
        self.axes = axes
        self.surface = surface
        self.tip = Tip((0.5, 0.0, 0.5), DOWN, RIGHT)

    def step(self, operator_input=NEUTRAL_STICKS):
        motion_request = self.teleoperation.step(
            DT, operator_input, self.tip, self.axes, self.surface
        )
        position = add(self.tip.position, motion_request.displacement)
        direction = motion_request.direction or self.tip.direction
        self.tip = Tip(position, direction, motion_request.across or self.tip.across)
        return motion_request

    def run_until_end(self):
        for _ in range(5000):
            motion_request = self.step()
            if motion_request.ended:
                return motion_request.ended
        raise AssertionError("the motion never ended")


def push(*translation, **others):
    return OperatorInput(translation=translation, **others)


def steered(choice):
    return TeleoperationSettings(steering=SteeringSettings(choice=choice))


def speed_after(hand, operator_input, ticks=100):
    for _ in range(ticks):
        motion_request = hand.step(operator_input)
    return length(motion_request.displacement) / DT


def test_a_stick_inside_the_round_dead_zone_moves_nothing():
    response = StickResponse(dead_zone=0.12)
    assert response((0.08, 0.08, 0.0)) == ZERO
    assert response((0.1, 0.1, 0.0)) != ZERO


def test_the_response_curve_starts_at_zero_rises_and_ends_at_full_speed():
    response = StickResponse(dead_zone=0.1, exponent=2.0)
    shares = [response((x, 0.0, 0.0))[0] for x in (0.1001, 0.3, 0.55, 0.8, 1.0)]
    assert shares[0] == pytest.approx(0.0, abs=1e-6)
    assert shares == sorted(shares)
    assert shares[2] == pytest.approx(0.25)
    assert shares[-1] == 1.0


def test_full_deflection_reaches_the_coarse_and_with_the_trigger_the_fine_speed():
    assert speed_after(Hand(), push(1.0, 0.0, 0.0)) == pytest.approx(SETTINGS.coarse_speed)
    assert speed_after(Hand(), push(1.0, 0.0, 0.0, fine=True)) == pytest.approx(SETTINGS.fine_speed)


def at_clearance(clearance):
    return Hand(surface=NearestSurface(clearance, (0.0, 0.0, 1.0), 0.05, (0.0, 0.0, 1.0)))


@pytest.mark.parametrize(("upward", "at_skin"), [(-1.0, 0.001), (1.0, 0.003)])
def test_slow_motion_is_slow_near_the_skin_however_far_a_stick_is_pushed(upward, at_skin):
    fine = push(0.0, 0.0, 0.7 * upward, fine=True)
    speeds = [speed_after(at_clearance(mm / 1000.0), fine) for mm in (-0.1, 0.0, 2.0, 6.0, 10.0)]
    assert speeds == sorted(speeds)
    assert speeds[0] == speeds[1] == pytest.approx(at_skin)
    assert speeds[2] == pytest.approx(0.003)
    assert speeds[-1] == speed_after(Hand(), fine)


def test_slow_motion_along_the_skin_keeps_its_direction_and_is_slowed_by_its_way_down_alone():
    along = at_clearance(0.0).step(push(1.0, 0.0, -0.1, fine=True)).displacement
    assert unit(along) == pytest.approx(unit((1.0, 0.0, -0.1)))
    assert speed_after(at_clearance(0.0), push(1.0, 0.0, -0.1, fine=True)) == pytest.approx(0.003)
    hand = at_clearance(0.0)
    assert speed_after(hand, push(1.0, 0.0, -1.0, fine=True)) == pytest.approx(0.001 * 2**0.5)


def test_speed_never_changes_faster_than_the_acceleration_limit_while_the_stick_is_held():
    hand = Hand()
    last = ZERO
    for stick in [(1.0, 0.0, 0.0)] * 50 + [(-1.0, 0.5, 0.0)] * 80 + [(0.0, 0.0, 1.0)] * 50:
        velocity = tuple(d / DT for d in hand.step(push(*stick)).displacement)
        assert distance(velocity, last) <= SETTINGS.acceleration * DT * (1 + 1e-9)
        last = velocity


def test_a_move_ends_on_its_target_and_never_exceeds_its_speed():
    hand = Hand()
    target = (0.42, 0.13, 0.41)
    hand.teleoperation.start(Moving(goal=target, speed=0.1))
    fastest = 0.0
    while (motion_request := hand.step()).ended is None:
        fastest = max(fastest, length(motion_request.displacement) / DT)
    assert motion_request.ended is MotionOutcome.REACHED
    assert distance(hand.tip.position, target) <= ARRIVED
    assert fastest <= 0.1 * (1 + 1e-9)


def test_a_move_turns_the_tool_as_commanded_even_if_its_direction_is_free():
    hand = Hand()
    goal = unit((0.0, 1.0, -1.0))
    hand.teleoperation.start(Moving((0.5, 0.0, 0.45), speed=0.1, direction=goal))
    assert hand.run_until_end() is MotionOutcome.REACHED
    assert angle(hand.tip.direction, goal) < 1e-9


def test_a_stick_overrides_a_commanded_motion():
    hand = Hand()
    hand.teleoperation.start(Moving((0.5, 0.0, 0.3), speed=0.1))
    hand.step()
    motion_request = hand.step(push(1.0, 0.0, 0.0))
    assert motion_request.ended is MotionOutcome.OVERRIDDEN
    assert motion_request.motion is Motion.STICK
    assert hand.step().motion is Motion.NONE


def test_in_position_mode_the_tool_direction_is_free_and_the_second_stick_does_nothing():
    hand = Hand(steered(ToolDirection.FREE))
    assert hand.step(push(1.0, 0.0, 0.0)).direction is None
    assert hand.step(OperatorInput(rotation=(1.0, 0.0))).motion is Motion.NONE


def test_a_held_direction_stays_until_the_second_stick_turns_it():
    hand = Hand(steered(ToolDirection.HELD))
    for _ in range(50):
        assert hand.step(push(1.0, 0.0, 0.0)).direction == DOWN
    for _ in range(50):
        motion_request = hand.step(OperatorInput(rotation=(1.0, 0.0)))
    assert motion_request.displacement == ZERO
    turned = hand.tip.direction
    assert turned[0] > 0.1
    assert turned[1] == pytest.approx(0.0)
    assert angle(turned, DOWN) == pytest.approx(50 * DT * SteeringSettings().coarse_turn)


def test_in_pose_mode_the_tool_does_not_roll_while_it_is_moved_and_turned():
    hand = Hand(steered(ToolDirection.POSE))
    for _ in range(50):
        motion_request = hand.step(push(1.0, 0.0, 0.0))
        assert (motion_request.direction, motion_request.across) == (DOWN, RIGHT)
    for _ in range(200):
        motion_request = hand.step(OperatorInput(rotation=(0.0, 1.0)))
    assert angle(motion_request.direction, DOWN) > 0.5
    assert motion_request.across == pytest.approx(RIGHT)
    for _ in range(200):
        motion_request = hand.step(OperatorInput(rotation=(1.0, 0.0)))
    assert dot(motion_request.across, motion_request.direction) == pytest.approx(0.0, abs=1e-12)
    assert length(motion_request.across) == pytest.approx(1.0)


def near_the_head(clearance, normal, shaft_clearance=0.1, shaft_normal=(0.0, 0.0, 1.0)):
    return NearestSurface(clearance, unit(normal), shaft_clearance, unit(shaft_normal))


def test_near_the_head_the_tool_turns_along_the_surface_normal_if_so_configured():
    normal = (0.0, -1.0, 0.5)
    near = Hand(steered(ToolDirection.NORMAL), surface=near_the_head(0.005, normal))
    far = Hand(steered(ToolDirection.NORMAL), surface=near_the_head(0.2, normal))
    for _ in range(600):
        near.step(push(0.2, 0.0, 0.0))
        far.step(push(0.2, 0.0, 0.0))
    assert near.tip.direction == pytest.approx(tuple(-v for v in unit(normal)))
    assert far.tip.direction == DOWN


def test_in_position_mode_the_tool_tilts_only_as_far_as_its_shaft_stays_off_the_skin():
    normal = (0.0, -1.0, 0.5)
    leans = []
    for clearance in (0.2, 0.12, 0.08, 0.04, 0.01, 0.0):
        hand = Hand(steered(ToolDirection.CLEAR), surface=near_the_head(clearance, normal))
        for _ in range(600):
            hand.step(push(0.2, 0.0, 0.0))
        leans.append(angle(hand.tip.direction, (0.0, 1.0, -0.5)))
    assert leans == sorted(leans, reverse=True)
    assert leans[:2] == pytest.approx([angle(DOWN, (0.0, 1.0, -0.5))] * 2)
    assert leans[-2:] == pytest.approx([SteeringSettings().largest_lean] * 2)


def test_the_tool_approaches_from_above_even_where_the_skin_faces_down():
    hand = Hand(steered(ToolDirection.NORMAL), surface=near_the_head(0.0, (0.0, -1.0, -0.4)))
    for _ in range(600):
        hand.step(push(0.2, 0.0, 0.0))
    assert hand.tip.direction[2] < -0.2
