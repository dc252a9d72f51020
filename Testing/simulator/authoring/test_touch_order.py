"""Distances along a head's surface, and how demanding a touch order is."""

import numpy as np
import pytest

from rastrainer_simulator.authoring.touch_order import SurfaceGraph, complexity
from Testing.domain.head.spheres import RADIUS_MM, on_sphere, sphere_mesh

FRONT = np.array([0.0, 700.0, 0.0])
MESH = sphere_mesh()
GRAPH = SurfaceGraph(MESH)


def test_a_path_over_a_sphere_is_2_5_percent_too_long_on_average_and_at_most_15():
    rng = np.random.default_rng(1)
    points = rng.normal(size=(60, 2, 3))
    points *= RADIUS_MM / np.linalg.norm(points, axis=2, keepdims=True)
    exact = RADIUS_MM * np.arccos(np.einsum("ij,ij->i", *points.transpose(1, 0, 2)) / RADIUS_MM**2)
    ratios = [GRAPH.distance(start, end) for start, end in points] / exact
    assert np.mean(ratios) == pytest.approx(1.025, abs=0.015)
    assert 0.995 <= ratios.min() <= ratios.max() <= 1.15


def of(*places):
    return complexity(np.array([on_sphere(*place) for place in places]), GRAPH, FRONT)


def test_a_great_circle_has_no_turns_and_reorients_the_tool_by_its_angle():
    found = of((90, -40), (90, -10), (90, 20), (90, 50))
    assert found.path_length_mm == pytest.approx(np.radians(90) * RADIUS_MM, rel=0.08)
    assert found.turning_deg == pytest.approx(0, abs=1.0)
    assert found.reorientation_deg == pytest.approx(90, abs=1.5)
    assert found.hidden_points == 0


def test_a_point_is_hidden_if_the_default_view_cannot_show_its_number():
    # In front, half aside, grazing, behind.
    for longitude, hidden in ((90, 0), (40, 0), (10, 1), (270, 1)):
        assert of((90, 0), (longitude, 0)).hidden_points == hidden


def test_an_occluded_point_is_hidden_even_if_it_faces_the_view():
    mesh = sphere_mesh(3)
    screen = np.array([[-50.0, 300, -50], [50, 300, -50], [0, 300, 80]])
    with_screen = type(mesh)(
        np.vstack([mesh.vertices, screen]),
        np.vstack([mesh.triangles, len(mesh.vertices) + np.array([[0, 1, 2]])]),
    )
    points = np.array([on_sphere(90, 0), on_sphere(60, 30)])
    assert complexity(points, SurfaceGraph(mesh), FRONT).hidden_points == 0
    graph = SurfaceGraph(with_screen)
    assert complexity(points, graph, FRONT).hidden_points == 1
