"""Errors of a planned procedure are reported, by the geometry of lines and bodies."""

import numpy as np
import pytest
import trimesh

from rastrainer.head.mesh import HeadMesh, mesh_crossings
from rastrainer.procedure import checks, geometry
from rastrainer.procedure.plan import Checkpoint, ProcedureMeshes
from Testing.domain.procedure.made_up_procedure import (
    made_up_meshes,
    made_up_procedure,
    shell,
    trajectory,
)
from Testing.domain.scenario.made_up_scenario import ball_head

HEAD = ball_head()


def wrong(*trajectories, meshes=None, **changes):
    procedure = made_up_procedure(*trajectories, **changes)
    return checks.check_procedure(procedure, HEAD, meshes or made_up_meshes())[1]


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        (trajectory(target=(0, 0, 120)), "has its target 30 mm outside of the head"),
        (trajectory(entry=(0, 0, 110)), "enters 20 mm above the skin"),
        (trajectory(entry=(0, 0, 75)), "enters 15 mm below the skin"),
        (trajectory(target=(0, 0, -70.0)), "is 160 mm long"),
        (trajectory(entry=(0, 55, 71), target=(0, -40, 70)), "meets the skull at 58°"),
        (trajectory(entry=(30, 0, 84.85), target=(30, 0, -20)), "goes through Vessel"),
        (trajectory(entry=(22.5, 0, 87.1), target=(22.5, 0, -20)), "comes within 1.5 mm of Vessel"),
    ],
    ids=["target", "above", "below", "long", "angle", "hit", "near"],
)
def test_an_unusable_line_is_reported_in_one_sentence_and_a_good_plan_is_not(line, sentence):
    assert wrong() == []
    (said,) = wrong(line)
    assert said.startswith(f"Two leads: Left {sentence}")


def test_a_line_that_leaves_the_head_is_reported_with_the_distance_before_its_target():
    left, right = (ball_head(40.0).vertices + np.array([x, 0.0, 0.0]) for x in (-50.0, 50.0))
    triangles = ball_head(40.0).triangles
    two = HeadMesh(
        np.concatenate([left, right]), np.concatenate([triangles, triangles + len(left)])
    )
    procedure = made_up_procedure(trajectory(entry=(-90, 0, 0), target=(30, 0, 0)))
    assert checks.check_procedure(procedure, two, made_up_meshes())[1] == [
        "Two leads: Left leaves the head 40 mm before its target; it must stay within it."
    ]


def test_a_line_that_misses_the_skull_has_nothing_to_drill():
    above = HeadMesh(shell().vertices * [1.0, 1.0, 0.1] - [0.0, 0.0, 60.0], shell().triangles)
    meshes = ProcedureMeshes(above, {})
    assert wrong(trajectory(), meshes=meshes) == [
        "Two leads: Left does not go through the skull; drilling needs bone."
    ]


def test_a_skull_without_an_inner_table_is_reported_as_such():
    meshes = ProcedureMeshes(ball_head(83.0), {})
    (sentence,) = wrong(trajectory(), meshes=meshes)
    assert "Left meets a skull without an inner table; make the skull again" in sentence


def test_instruments_that_come_too_close_to_each_other_are_both_named():
    one = trajectory("One", (0, 0, 90), (0, 0, 20))
    other = trajectory("Other", (40, 0, 80.6), (2.5, 0, 20))
    assert wrong(one, other) == [
        "Two leads: One and Other come within 0.5 mm of each other; they must stay 1 mm apart."
    ]


def test_a_checkpoint_off_the_skin_is_named():
    points = (Checkpoint("Vertex", np.array([0.0, 0.0, 87.0])),)
    assert wrong(checkpoints=points) == [
        "Two leads: the checkpoint Vertex is 3.0 mm off the skin; it must be within 1 mm."
    ]


def test_a_line_is_measured_by_length_angle_and_its_nearest_structure_and_line():
    one = trajectory("One", (0, 0, 90), (0, 0, 20), diameter=2.0)
    other = trajectory("Other", (40, 0, 80.6), (2.5, 0, 20), diameter=3.0)
    outside = trajectory("Outside", (0, 0, 200), (0, 0, 150))
    procedure = made_up_procedure(one, other, outside)
    measured = {each.name: each for each in checks.measure_lines(procedure, made_up_meshes())}
    assert measured["One"].length_mm == pytest.approx(70.0)
    assert measured["One"].skull_angle_deg == pytest.approx(0.0, abs=3.0)
    assert measured["One"].nearest_no_go == "Vessel"
    assert measured["One"].nearest_line == "Other"
    assert measured["One"].nearest_line_mm == pytest.approx(2.5 - 2.5, abs=0.1)
    assert measured["Outside"].skull_angle_deg is None
    (alone,) = checks.measure_lines(made_up_procedure(one), made_up_meshes())
    assert (alone.nearest_line, alone.nearest_line_mm) == ("", None)


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
