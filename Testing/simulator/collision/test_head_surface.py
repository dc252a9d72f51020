import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.head_surface import HeadSurface, thin_segment
from Testing.simulator.collision.brute_force import (
    point_to_triangles,
    segment_to_triangles,
    vtk_distance,
)
from Testing.simulator.collision.heads_and_arms import ball, bumpy_head

MICROMETER = 1e-6


@pytest.fixture(scope="module")
def bumpy():
    return bumpy_head()


def around(vertices, count, seed):
    """Points in the box about a surface, half as large again, inside and outside."""
    random = np.random.default_rng(seed)
    lowest, highest = vertices.min(axis=0), vertices.max(axis=0)
    shares = random.uniform(-0.25, 1.25, (count, 3))
    return lowest + shares * (highest - lowest)


def near(vertices, triangles, count, seed):
    """Points at faces, edges and vertices, from a nanometer to a millimeter away."""
    random = np.random.default_rng(seed)
    shares = random.dirichlet((1.0, 1.0, 1.0), count)
    shares[: count // 3] = np.eye(3)[random.integers(3, size=count // 3)]
    edges = slice(count // 3, 2 * count // 3)
    shares[edges, 0] = 0.0
    shares /= shares.sum(axis=1, keepdims=True)
    corners = vertices[triangles[random.integers(len(triangles), size=count)]]
    away = random.normal(size=(count, 3)) * 10.0 ** random.uniform(-9, -3, (count, 1))
    return np.einsum("nk,nki->ni", shares, corners) + away


def distances(surface, points):
    return np.array([surface.nearest_to_point(tuple(p)).distance_m for p in points.tolist()])


def test_the_distance_of_a_point_matches_brute_force(bumpy):
    vertices, triangles = bumpy
    points = np.concatenate([around(*bumpy[:1], 40, 2), near(*bumpy, 40, 3)])
    expected = [point_to_triangles(p, vertices[triangles]).min() for p in points]
    found = np.abs(distances(HeadSurface(*bumpy), points))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


def test_the_sign_is_right_on_the_default_head(scenario):
    mesh = read_head_mesh(scenario.head)
    head = mesh.vertices / MM_PER_M, mesh.triangles
    points = np.concatenate([around(head[0], 100, 6), near(*head, 300, 7)])
    truth = np.array(list(map(vtk_distance(*head), points)))
    np.testing.assert_allclose(
        distances(HeadSurface(*head), points), truth, rtol=0, atol=MICROMETER
    )


def test_the_distance_of_a_capsule_matches_brute_force_along_its_axis():
    vertices, triangles = bumpy_head(subdivisions=3)
    surface, random = HeadSurface(vertices, triangles), np.random.default_rng(9)
    checked = 0
    for point in around(vertices, 60, 10):
        axis = random.normal(size=3)
        end = point + axis / np.linalg.norm(axis) * random.choice([0.004, 0.1])
        found = surface.nearest_to_segment(
            thin_segment(point, end), tuple(point), tuple(end), 0.003
        )
        expected = segment_to_triangles(point, end, vertices[triangles]).min()
        if found.distance_m < -0.003:
            expected = -expected
            assert surface.nearest_to_point(tuple(point)).distance_m < 0.0
            checked += 1
        assert found.distance_m == pytest.approx(expected - 0.003, abs=1e-9)
    assert checked > 2


def test_a_triangle_without_area_does_not_corrupt_the_sign():
    vertices, triangles = ball(0.1, 2)
    a, b, c = triangles[0]
    middle = len(vertices)
    vertices = np.concatenate([vertices, [(vertices[a] + vertices[b]) / 2.0]])
    split = [(a, middle, c), (middle, b, c), (a, b, middle)]
    surface = HeadSurface(vertices, np.concatenate([triangles[1:], split]))
    for inward in (1e-7, 1e-4, 0.01, -1e-7, -1e-4, -0.01):
        point = vertices[middle] * (1.0 - inward / np.linalg.norm(vertices[middle]))
        assert np.sign(surface.nearest_to_point(tuple(point)).distance_m) == -np.sign(inward)


def test_an_inside_out_surface_is_turned_outward():
    vertices, triangles = ball(0.1, 3)
    surface = HeadSurface(vertices, triangles[:, ::-1])
    assert surface.nearest_to_point((0.0, 0.0, 0.05)).distance_m < 0.0
    assert surface.nearest_to_point((0.0, 0.0, 0.2)).distance_m > 0.0


def test_an_unusable_surface_is_refused_with_a_message():
    vertices, triangles = ball(0.1, 2)
    with pytest.raises(InputError, match=r"should be closed.* 3 edges are not"):
        HeadSurface(vertices, triangles[1:])
