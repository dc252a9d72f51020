"""Distances along a head's surface."""

import numpy as np
import pytest

from rastrainer_simulator.authoring.touch_order import SurfaceGraph
from Testing.domain.head.spheres import RADIUS_MM, on_sphere, sphere_mesh


@pytest.fixture(scope="module")
def graph():
    return SurfaceGraph(sphere_mesh())


@pytest.mark.parametrize("degrees", [20, 60, 90, 150])
def test_the_path_over_a_sphere_is_its_great_circle_within_a_tenth(graph, degrees):
    exact = np.radians(degrees) * RADIUS_MM
    for longitude in range(0, 360, 40):
        way = graph.distance(on_sphere(longitude, 10), on_sphere(longitude, 10 + degrees))
        assert 0.995 * exact <= way <= 1.10 * exact


def test_the_path_is_a_few_percent_too_long_on_average(graph):
    rng = np.random.default_rng(1)
    points = rng.normal(size=(60, 2, 3))
    points *= RADIUS_MM / np.linalg.norm(points, axis=2, keepdims=True)
    exact = RADIUS_MM * np.arccos(np.einsum("ij,ij->i", *points.transpose(1, 0, 2)) / RADIUS_MM**2)
    ways = [graph.distance(start, end) for start, end in points]
    assert np.mean(ways / exact) == pytest.approx(1.025, abs=0.015)


def test_the_path_is_symmetric(graph):
    a, b = on_sphere(30, 20), on_sphere(160, -10)
    assert graph.distance(a, b) == pytest.approx(graph.distance(b, a))


def test_within_one_triangle_the_path_is_straight():
    mesh = sphere_mesh(1)
    a, b = np.array([[0.5, 0.3, 0.2], [0.2, 0.3, 0.5]]) @ mesh.vertices[mesh.triangles[7]]
    assert SurfaceGraph(mesh).distance(a, b) == pytest.approx(np.linalg.norm(a - b))
