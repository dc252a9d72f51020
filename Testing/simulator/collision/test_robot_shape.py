import numpy as np
import pytest
import trimesh

from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.collision.robot_shape import SHAFT_START
from Testing.simulator.collision.heads_and_arms import SHAPE


def collision_mesh(link) -> trimesh.Trimesh:
    name = f"{link.name.removeprefix('iiwa_')}.stl"
    return trimesh.load_mesh(asset_path("robots", "iiwa7", "meshes", "collision", name))


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
    mesh = collision_mesh(link)
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


def test_the_tool_is_covered_except_for_its_last_three_millimeters():
    mesh = collision_mesh(SHAPE.tool)
    points = sampled(mesh, 20000) - [0.0, 0.0, 0.2]
    shaft = points[points[:, 2] < -SHAFT_START]
    assert beyond(shaft, SHAPE.tool.capsules).max() <= 2e-5
    assert beyond(np.zeros((1, 3)), SHAPE.tool.capsules)[0] > 0.002


def test_a_tool_tilted_by_sixty_degrees_still_touches_a_plane_with_its_tip_first():
    lean = np.radians(60.0)
    to_plane = np.array([np.sin(lean), 0.0, -np.cos(lean)])
    for capsule in SHAPE.tool.capsules[:2]:
        heights = [end @ to_plane - capsule.radius for end in (capsule.start, capsule.end)]
        assert min(heights) > 0.0
