"""The nearest points of many points on a mesh, against the search for a single point."""

import numpy as np
import pytest

from rastrainer.head.mesh import HeadMesh, nearest_on_mesh
from rastrainer.head.triangle_tree import FollowedPoints, TriangleTree
from Testing.domain.head.spheres import sphere_mesh


@pytest.fixture(scope="module")
def head():
    """A sphere with bumps as small as a nose and an ear."""
    ball = sphere_mesh(4)
    bumps = 1.0 + 0.1 * np.cos(ball.vertices / 6.0).prod(axis=1)
    return HeadMesh(ball.vertices * bumps[:, None], ball.triangles)


@pytest.mark.parametrize("off_mm", [0.0, 0.5, 5.0, 60.0])
def test_nearest_points_of_many_match_those_found_one_by_one(head, off_mm):
    random = np.random.default_rng(1)
    points = head.vertices[random.integers(0, len(head.vertices), 25)]
    points = points + off_mm * random.normal(0.0, 1.0, points.shape)
    found = head.tree.nearest(points)
    singles = [nearest_on_mesh(head, point) for point in points]
    assert np.allclose(found.distances, [one.distance for one in singles], atol=1e-9)
    corners = head.vertices[head.triangles[found.triangles]]
    assert (found.positions >= corners.min(axis=1) - 1e-9).all()
    assert (found.positions <= corners.max(axis=1) + 1e-9).all()


def test_tracked_points_have_the_same_nearest_points_as_a_new_search(head):
    random = np.random.default_rng(2)
    points = head.vertices[random.integers(0, len(head.vertices), 60)] + random.normal(
        0, 3, (60, 3)
    )
    followed = FollowedPoints(head.tree, points, 0.0)
    assert np.array_equal(followed.nearest.positions, head.tree.nearest(points).positions)
    for step, size in enumerate((20.0, 3.0, 0.8, 0.5, 0.3, 0.01)):
        moves = random.normal(0.0, size, points.shape)
        points = points + moves
        # Some move farther than predicted.
        found = followed.move(points, 0.7 * np.linalg.norm(moves, axis=1))
        again = head.tree.nearest(points)
        assert np.allclose(found.distances, again.distances, atol=1e-12)
        assert np.allclose(found.positions, again.positions, atol=1e-9)
        kept = np.delete(np.arange(len(points)), step)
        followed.keep(kept)
        points = points[kept]


def test_copies_of_tracked_points_have_the_same_nearest_points_as_a_new_search(head):
    random = np.random.default_rng(3)
    points = head.vertices[random.integers(0, len(head.vertices), 40)]
    points = points + random.normal(0.0, 1.0, points.shape)
    moves = random.normal(0.0, 0.4, (3, 40, 3))
    slack = np.linalg.norm(moves, axis=2)
    followed = FollowedPoints(head.tree, points, slack.max(axis=0))
    followed.repeat(slack)
    for share in (1.0, 0.3, 2.0):
        places = (points + share * moves).reshape(-1, 3)
        found, again = followed.move(places, slack.ravel()), head.tree.nearest(places)
        assert np.allclose(found.distances, again.distances, atol=1e-12)
        assert np.allclose(found.positions, again.positions, atol=1e-9)


def test_a_single_triangle_and_degenerate_triangles_have_nearest_points():
    corners = np.array([[[0.0, 0, 0], [2, 0, 0], [0, 2, 0]], [[5.0, 0, 0], [6, 0, 0], [7, 0, 0]]])
    one = TriangleTree(corners[:1]).nearest(np.array([[0.5, 0.5, 3.0], [-1.0, -1.0, 0.0]]))
    assert np.allclose(one.positions, [[0.5, 0.5, 0.0], [0.0, 0.0, 0.0]])
    line = TriangleTree(corners).nearest(np.array([[6.5, 0.0, 1.0]]))
    assert np.allclose(line.positions, [[6.5, 0.0, 0.0]])
    assert line.triangles[0] == 1
