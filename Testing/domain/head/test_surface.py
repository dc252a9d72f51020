"""Nearest points, normals and visibility on a surface."""

import numpy as np
import trimesh

from rastrainer.head.mesh import hides, nearest_on_mesh, outward_normal
from Testing.domain.head.spheres import on_sphere, sphere_mesh


def test_the_nearest_points_agree_with_trimesh():
    mesh = sphere_mesh(3)
    points = np.random.default_rng(3).uniform(-150, 150, (200, 3))
    other = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    positions, distances, _ = trimesh.proximity.closest_point(other, points)
    found = [nearest_on_mesh(mesh, point) for point in points]
    assert np.allclose([nearest.distance for nearest in found], distances, atol=1e-9)
    assert np.allclose([nearest.position for nearest in found], positions, atol=1e-6)


def test_barycentric_weights_give_the_nearest_point_back():
    mesh = sphere_mesh(3)
    nearest = nearest_on_mesh(mesh, np.array([20.0, 120.0, -30.0]))
    corners = mesh.vertices[mesh.triangles[nearest.triangle]]
    assert np.allclose(nearest.weights @ corners, nearest.position)


def test_normals_point_away_from_the_center():
    for point in (on_sphere(10, 80), on_sphere(200, -20)):
        normal = outward_normal(sphere_mesh(), point)
        assert normal @ point / np.linalg.norm(point) > 0.9995


def test_the_far_side_is_hidden_and_the_near_side_is_not():
    mesh, eye = sphere_mesh(), np.array([0.0, 700.0, 0.0])
    assert not hides(mesh, eye, on_sphere(90, 10))
    assert not hides(mesh, eye, on_sphere(20, 0))
    assert hides(mesh, eye, on_sphere(270, 10))


def test_visibility_agrees_with_trimesh():
    rng = np.random.default_rng(8)
    mesh, eye = sphere_mesh(3), np.array([100.0, 400.0, 300.0])
    points = rng.uniform(-140, 140, (200, 3))
    other = trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
    ways = points - eye
    hits, rays, _ = other.ray.intersects_location(np.tile(eye, (200, 1)), ways)
    before = np.linalg.norm(hits - eye, axis=1) < np.linalg.norm(ways, axis=1)[rays] - 1.0
    expected = np.isin(np.arange(200), rays[before])
    assert [hides(mesh, eye, point) for point in points] == expected.tolist()
