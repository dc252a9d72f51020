import numpy as np
import pytest

from rastrainer_simulator.collision.clearance import FAR, SHAFT_NEAR
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.robot_shape import ArmCapsules
from Testing.simulator.collision.brute_force import (
    segment_to_segments,
    segment_to_triangles,
    vtk_distance,
)
from Testing.simulator.collision.heads_and_arms import (
    KINEMATICS,
    ROBOT,
    SHAPE,
    at,
    bumpy_head,
    posture,
)

FIVE_HUNDREDTHS_MM = 5e-5
CENTER = (0.5, 0.0, 0.25)
ARM = ArmCapsules(SHAPE)


@pytest.fixture(scope="module")
def head():
    return bumpy_head(subdivisions=3)


@pytest.fixture(scope="module")
def head_to_world(head):
    pose = at(head[0], CENTER)
    turn = np.radians(25.0)
    pose[:2, :2] = [[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]]
    return pose


@pytest.fixture
def collision(head, head_to_world):
    return placed(head, head_to_world)


def placed(head, head_to_world, **surroundings):
    found = Collision(SHAPE, *head, **surroundings)
    found.set_head_pose(head_to_world)
    return found


@pytest.fixture(scope="module", params=[20, pytest.param(100, marks=pytest.mark.soak)])
def postures(head, request):
    """Postures with the tip near, at and in the head, the tool from any side it can come from."""
    random = np.random.default_rng(21)
    found = []
    while len(found) < request.param:
        place = head[0][random.integers(len(head[0]))]
        outward = place / np.linalg.norm(place) + random.normal(size=3) * 0.4
        outward /= np.linalg.norm(outward)
        tip = np.array(CENTER) + place + outward * random.choice([-0.03, 0.0, 0.002, 0.05])
        q = posture(tip, -outward)
        if q is not None:
            found.append(q)
    return found


def wander(count, seed, step=0.02):
    """Joint angles of a random walk from home."""
    random, q = np.random.default_rng(seed), np.array(ROBOT.home)
    for _ in range(count):
        q = np.clip(q + random.normal(size=7) * step, *ROBOT.limits)
        yield q


def corners_in_world(head, head_to_world):
    vertices = head[0] @ head_to_world[:3, :3].T + head_to_world[:3, 3]
    return vertices, vertices[head[1]]


def brute_capsules(posed, rows, corners, signed):
    """The least signed distance of some capsules, and the row of the nearest."""
    best = []
    for row in rows:
        axis = segment_to_triangles(*posed.ends[row], corners).min()
        axis *= np.sign(signed(posed.ends[row, 0])) if axis > 0.0 else 0.0
        best.append((axis - ARM.radii[row], row))
    return min(best)


def test_clearances_of_tip_and_shaft_are_those_of_brute_force(
    head, head_to_world, collision, postures
):
    vertices, corners = corners_in_world(head, head_to_world)
    signed = vtk_distance(vertices, head[1])
    inside = near = 0
    for q in postures:
        links = KINEMATICS.links(q)
        found, posed = collision.check(links), ARM.pose(links)
        assert found.tip_m == pytest.approx(signed(posed.tip), abs=FIVE_HUNDREDTHS_MM)
        inside += found.tip_m < -0.02
        tool = range(ARM.link_count, len(ARM.capsules))
        expected, _ = brute_capsules(posed, tool, corners, signed)
        assert found.tool_m == pytest.approx(min(found.tip_m, expected), abs=FIVE_HUNDREDTHS_MM)
        far = max(found.tip_m, SHAFT_NEAR)
        assert found.shaft_m == pytest.approx(min(expected, far), abs=FIVE_HUNDREDTHS_MM)
        assert (found.shaft is None) == (expected >= far)
        exact = collision.nearest_to_shaft(links, np.inf).distance_m
        assert exact == pytest.approx(expected, abs=FIVE_HUNDREDTHS_MM)
        near += found.shaft is not None
    assert inside > 0
    assert 0 < near < len(postures)


def test_the_clearance_of_the_links_is_that_of_brute_force(head, head_to_world):
    lowered = head_to_world.copy()
    lowered[:3, 3] = (0.35, 0.05, 0.45)
    collision = placed(head, lowered)
    vertices, corners = corners_in_world(head, lowered)
    signed = vtk_distance(vertices, head[1])
    near = overlapping = 0
    for q in wander(12, seed=22, step=0.15):
        links = KINEMATICS.links(q)
        found, posed = collision.check(links), ARM.pose(links)
        expected, _row = brute_capsules(posed, range(ARM.link_count), corners, signed)
        assert found.links_m == pytest.approx(min(expected, FAR), abs=FIVE_HUNDREDTHS_MM)
        near += expected < FAR
        overlapping += expected < 0.0
    assert near > 4
    assert overlapping > 1


def test_the_arms_distance_to_itself_matches_brute_force(collision):
    random = np.random.default_rng(23)
    near = overlapping = 0
    folded = np.radians([170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 175.0])
    for q in random.uniform(-1.0, 1.0, (80, 7)):
        q[[1, 3]] = np.sign(q[[1, 3]]) * (0.8 + 0.2 * np.abs(q[[1, 3]]))
        q *= folded
        links = KINEMATICS.links(q)
        found, posed = collision.check(links), ARM.pose(links)
        gaps = []
        for i in range(len(ARM.capsules)):
            apart = np.abs(ARM.joints - ARM.joints[i]) >= 3
            axes = segment_to_segments(*posed.ends[i], posed.ends[apart, 0], posed.ends[apart, 1])
            gaps.extend(axes - ARM.radii[i] - ARM.radii[apart])
        assert found.self_m == pytest.approx(min(*gaps, FAR), abs=1e-9)
        near += min(gaps) < FAR
        overlapping += min(gaps) < 0.0
    assert near > 8
    assert overlapping > 0


def test_the_heads_stand_is_an_upright_column_under_its_base(head):
    raised = at(head[0], (0.5, 0.0, 0.45))
    collision = placed(head, raised, stand_radius=0.03)
    vertices, _ = corners_in_world(head, raised)
    x, y, _ = vertices[vertices[:, 2] < vertices[:, 2].min() + 0.001].mean(axis=0)
    # The tool's first capsule begins where its round end comes nearest to the tip.
    capsule = ARM.capsules[ARM.link_count]
    behind = np.linalg.norm(capsule.start) - capsule.radius
    for gap in (0.08, 0.03, 0.01, -0.005):
        q = posture((x, y - 0.03 - gap, 0.2), (0.0, 1.0, 0.0))
        found = collision.check(KINEMATICS.links(q))
        assert found.table_m == pytest.approx(gap + behind, abs=0.002)
