import numpy as np
import pytest
import trimesh

from rastrainer.errors import InputError
from rastrainer_simulator.collision.robot_shape import (
    SHAFT_START,
    capsules_along,
    covering_capsules,
    robot_shape,
    surface_points,
)
from rastrainer_simulator.robot.meshes import load_meshes
from rastrainer_simulator.robot.model import load_robot
from Testing.simulator.collision.heads_and_arms import ROBOT, SHAPE

MESHES = load_meshes(ROBOT, "collision")


def beyond(points, capsules):
    """How far each point is outside the nearest of some capsules."""
    gaps = []
    for capsule in capsules:
        axis = capsule.end - capsule.start
        size = max(axis @ axis, 1e-12)
        share = np.clip((points - capsule.start) @ axis / size, 0.0, 1.0)
        off = np.linalg.norm(points - capsule.start - share[:, None] * axis, axis=1)
        gaps.append(off - capsule.radius)
    return np.min(gaps, axis=0)


def sampled(mesh, count=5000):
    return np.array(trimesh.sample.sample_surface(mesh, count, seed=1)[0])


@pytest.mark.parametrize("link", SHAPE.links, ids=lambda link: link.name)
def test_capsules_cover_their_link_and_reach_little_beyond(link):
    ((mesh, _),) = MESHES[link.name]
    assert beyond(sampled(mesh), link.capsules).max() <= 1e-9
    surface = np.concatenate([capsule_surface(capsule) for capsule in link.capsules])
    outside = surface[beyond(surface, link.capsules) > -1e-9]
    reach = trimesh.proximity.closest_point(mesh, outside)[1]
    assert np.median(reach) < 0.03
    assert reach.max() < 0.08


def capsule_surface(capsule, count=300):
    directions = np.random.default_rng(2).normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    axis = capsule.end - capsule.start
    ends = np.where((directions @ axis > 0.0)[:, None], capsule.end, capsule.start)
    return ends + capsule.radius * directions


def test_every_link_with_a_collision_mesh_is_covered():
    names = {link.name for link in SHAPE.links} | {SHAPE.tool.name}
    assert names == set(MESHES)
    assert SHAPE.tool.name == "iiwa_link_tool"


def test_the_tool_is_covered_except_for_its_last_three_millimeters():
    ((mesh, _),) = MESHES[SHAPE.tool.name]
    points = sampled(mesh, 20000) - [0.0, 0.0, 0.2]
    shaft = points[points[:, 2] < -SHAFT_START]
    assert beyond(shaft, SHAPE.tool.capsules).max() <= 2e-5
    assert beyond(np.zeros((1, 3)), SHAPE.tool.capsules)[0] > 0.002


@pytest.mark.parametrize("leaning_deg", [0.0, 20.0, 40.0, 55.0, 60.0])
def test_a_tool_tilted_by_sixty_degrees_still_touches_a_plane_with_its_tip_first(leaning_deg):
    lean = np.radians(leaning_deg)
    to_plane = np.array([np.sin(lean), 0.0, -np.cos(lean)])
    for capsule in SHAPE.tool.capsules[:2]:
        heights = [end @ to_plane - capsule.radius for end in (capsule.start, capsule.end)]
        assert min(heights) > 0.0


def test_the_slender_part_of_the_tool_stays_slender():
    tip, shaft, *_ = SHAPE.tool.capsules
    assert tip.radius < 0.002
    assert shaft.radius < 0.0035
    assert shaft.end[2] < -0.1


def test_a_straight_cylinder_is_one_capsule_of_its_radius():
    cylinder = trimesh.creation.cylinder(0.004, 0.1, sections=64)
    cylinder.apply_translation([0, 0, 0.05])
    points = surface_points(cylinder.vertices, cylinder.faces, 0.0005)
    (capsule,) = capsules_along(points, 0.02, count=1)
    assert capsule.radius == pytest.approx(0.004)
    assert capsule.start[2] == pytest.approx(0.02, abs=0.001)
    assert capsule.end[2] == pytest.approx(0.1, abs=0.001)


def test_a_long_solid_gets_two_capsules_and_a_short_one_one():
    for height, count in ((0.1, 1), (0.3, 2)):
        block = trimesh.creation.box(extents=(0.1, 0.1, height))
        points = surface_points(block.vertices, block.faces, 0.01)
        assert len(covering_capsules(points, 0.01)) == count


def test_points_on_a_mesh_are_no_farther_apart_than_requested():
    block = trimesh.creation.box(extents=(0.1, 0.2, 0.3))
    points = surface_points(block.vertices, block.faces, 0.01)
    edge = points[(points[:, 0] == 0.05) & (points[:, 1] == 0.1)]
    gaps = np.diff(np.unique(edge[:, 2]))
    assert gaps.max() <= 0.01 + 1e-12


def test_the_same_robot_always_gets_the_same_capsules():
    again = robot_shape(load_robot())
    for ours, theirs in zip(SHAPE.links, again.links, strict=True):
        for a, b in zip(ours.capsules, theirs.capsules, strict=True):
            assert (a.start == b.start).all()
            assert (a.end == b.end).all()
            assert a.radius == b.radius


def test_a_tool_one_millimeter_long_is_covered_too():
    stub = trimesh.creation.cylinder(0.004, 0.001)
    stub.apply_translation([0.0, 0.0, 0.0028])
    points = surface_points(stub.vertices, stub.faces, 0.0005)
    (capsule,) = capsules_along(points, 0.003)
    assert capsule.radius == pytest.approx(0.004)


@pytest.mark.parametrize("shift", [0.0, -0.1])
def test_a_tool_that_lies_in_front_of_its_tip_is_refused(shift):
    points = np.array([[0.001, 0.0, shift], [0.0, 0.001, shift]])
    with pytest.raises(InputError, match="from its tip toward the wrist"):
        capsules_along(points, 0.003)


def test_a_mesh_with_kilometers_of_edges_is_refused():
    vertices = np.random.default_rng(1).uniform(-10.0, 10.0, (3000, 3))
    with pytest.raises(InputError, match="should be a coarse hull"):
        surface_points(vertices, np.arange(3000).reshape(-1, 3), 0.0005)
