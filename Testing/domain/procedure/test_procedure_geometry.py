"""Lines through surfaces, and distances of segments, on bodies whose geometry is known."""

import numpy as np
import pytest
import trimesh

from rastrainer.head.mesh import HeadMesh, mesh_crossings
from rastrainer.procedure import geometry
from Testing.domain.procedure.made_up_procedure import shell
from Testing.domain.scenario.made_up_scenario import ball_head

Z = np.array([0.0, 0.0, 1.0])


def unit(vector):
    return np.array(vector) / np.linalg.norm(vector)


def slabs(*heights):
    """Closed boxes, 100 mm wide, from one height to another."""
    boxes = [
        trimesh.creation.box(bounds=[[-50, -50, low], [50, 50, high]]) for low, high in heights
    ]
    whole = trimesh.util.concatenate(boxes)
    return HeadMesh(np.array(whole.vertices), np.array(whole.faces))


@pytest.mark.parametrize("seed", range(4))
def test_a_line_crosses_a_sphere_at_the_two_expected_points(seed):
    random = np.random.default_rng(seed)
    ball, start = ball_head(90.0), 150.0 * unit(random.normal(size=3))
    direction = unit(random.normal(0.0, 25.0, 3) - start)
    entering, leaving = mesh_crossings(ball, start, direction, 400.0)
    assert entering.is_entering
    assert not leaving.is_entering
    along = -start @ direction
    half = np.sqrt(90.0**2 - start @ start + along**2)
    # The ball is made of flat triangles, within 0.6 mm of its sphere.
    assert entering.distance_mm == pytest.approx(along - half, abs=1.5)
    assert leaving.distance_mm == pytest.approx(along + half, abs=1.5)


@pytest.mark.parametrize(
    ("x", "y"), [(0.0, 0.0), (10.0, 10.0), (50.0 - 1e-12, 0.0)], ids=["diagonal", "edge", "border"]
)
def test_a_line_through_the_edge_of_two_triangles_crosses_once(x, y):
    crossings = mesh_crossings(slabs((0.0, 10.0)), np.array([x, y, 30.0]), -Z, 100.0)
    assert [crossing.is_entering for crossing in crossings] == [True, False]
    assert [crossing.distance_mm for crossing in crossings] == pytest.approx([20.0, 30.0])


def test_marrow_between_two_tables_is_bone_and_deeper_tissue_is_not():
    skull = slabs((47.0, 50.0), (43.5, 44.5), (10.0, 20.0))
    bone = geometry.bone_ahead(skull, np.array([1.0, 2.0, 80.0]), -Z, 200.0)
    assert bone == pytest.approx((30.0, 36.5))


def test_solid_bone_has_no_inner_table_within_reach():
    bone = geometry.bone_ahead(slabs((0.0, 50.0)), np.array([1.0, 2.0, 80.0]), -Z, 60.0)
    assert bone.outer_mm == pytest.approx(30.0)
    assert bone.inner_mm is None


def test_only_points_enclosed_by_the_surface_are_inside():
    for distance, expected in ((60.0, False), (80.0, True), (86.0, False)):
        for seed in range(3):
            out = unit(np.random.default_rng(seed).normal(size=3))
            assert geometry.is_inside(shell(), distance * out) is expected


@pytest.mark.parametrize("degrees", [0.0, 1e-7, 0.5, 37.0, 90.0, 180.0 - 1e-7, 180.0])
def test_an_angle_is_exact_even_if_small(degrees):
    radians = np.radians(degrees)
    turned = np.array([np.sin(radians), 0.0, np.cos(radians)])
    assert geometry.angle_deg(3.0 * Z, turned) == pytest.approx(degrees, abs=1e-12)


def brute(start, end, other_start, other_end):
    """The least distance between many points of two segments."""
    shares = np.linspace(0.0, 1.0, 401)[:, None]
    one, other = start + shares * (end - start), other_start + shares * (other_end - other_start)
    return np.linalg.norm(one[:, None] - other[None], axis=2).min()


@pytest.mark.parametrize("seed", range(8))
def test_the_distance_of_segments_is_that_of_their_nearest_points(seed):
    random = np.random.default_rng(seed)
    start, end, other, its_end = random.uniform(-10.0, 10.0, (4, 3))
    if seed % 4 == 1:
        its_end = other + 2.0 * (end - start)
    if seed % 4 == 2:
        its_end = other.copy()
    (found,) = geometry.segment_distances_mm(start, end, other[None], its_end[None])
    sampled = brute(start, end, other, its_end)
    assert found <= sampled + 1e-12
    assert found == pytest.approx(sampled, abs=0.05)


@pytest.mark.parametrize("seed", range(3))
def test_the_distance_of_an_axis_from_a_body_is_that_of_its_nearest_point(seed):
    random = np.random.default_rng(seed)
    ball = ball_head(30.0)
    start, end = random.normal(0.0, 45.0, (2, 3))
    solid = trimesh.Trimesh(ball.vertices, ball.triangles, process=False)
    places = start + np.linspace(0.0, 1.0, 200)[:, None] * (end - start)
    signed = trimesh.proximity.signed_distance(solid, places)
    expected = 0.0 if signed.max() >= 0.0 else -signed.max()
    assert geometry.axis_distance_mm(ball, start, end) == pytest.approx(expected, abs=0.05)


@pytest.mark.parametrize(
    ("start", "end", "expected"),
    [
        ((0, 0, 200), (0, 0, 150), 60.0),
        ((0, 0, 200), (0, 0, 0), 0.0),
        ((0, 0, 10), (0, 0, 20), 0.0),
        ((0, 0, 200), (0, 0, 200), 110.0),
    ],
    ids=["outside", "into", "within", "a point"],
)
def test_an_axis_that_meets_a_body_or_lies_in_it_is_at_zero_distance(start, end, expected):
    start, end = np.array(start, dtype=float), np.array(end, dtype=float)
    assert geometry.axis_distance_mm(ball_head(90.0), start, end) == pytest.approx(
        expected, abs=1e-9
    )
