"""Only the face is removed from a head."""

import numpy as np
import pytest

from rastrainer.head.mesh import HeadMesh
from rastrainer_simulator.authoring.face_removal import (
    RADIUS_MM,
    face_vertices,
    nose_tip,
    without_face,
)
from Testing.domain.head.spheres import sphere_mesh

NOSE = np.array([4.0, 90.0, -35.0])
BASE = -75.0


def head(nose_mm=22.0, brow_mm=4.0):
    """A ball with a flat base, a nose, and recognizable brows."""
    sphere = sphere_mesh(5)
    vertices = sphere.vertices.copy()
    direction = NOSE / np.linalg.norm(NOSE)
    outward = vertices / 90.0
    away = np.linalg.norm(vertices - 90.0 * direction, axis=1)
    bump = nose_mm * np.exp(-((away / 12.0) ** 2))
    brows = brow_mm * np.cos(vertices[:, 0] / 6.0) * np.exp(-(((away - 40.0) / 12.0) ** 2))
    vertices += outward * (bump + brows)[:, None]
    vertices[:, 2] = np.maximum(vertices[:, 2], BASE)
    return HeadMesh(vertices, sphere.triangles)


@pytest.fixture(scope="module")
def face():
    return head()


@pytest.fixture(scope="module")
def faceless(face):
    return without_face(face)


def test_nothing_but_the_face_changes(face, faceless):
    away = np.linalg.norm(face.vertices - nose_tip(face), axis=1)
    assert np.array_equal(faceless.vertices[away >= RADIUS_MM], face.vertices[away >= RADIUS_MM])
    assert np.array_equal(faceless.triangles, face.triangles)
    assert faceless.is_closed
    assert faceless.vertices[:, 2].min() == BASE


def test_the_face_is_smooth_afterward(face, faceless):
    is_face = face_vertices(face)
    assert is_face.sum() > 500
    distance = np.linalg.norm(faceless.vertices[is_face], axis=1)
    assert 70 < distance.min() < distance.max() < 95
    assert np.linalg.norm(face.vertices[is_face], axis=1).max() > 110


def test_heads_that_differ_only_in_the_face_are_equal_without_it(faceless):
    other = without_face(head(nose_mm=22.0, brow_mm=-3.0))
    before = np.abs(head(brow_mm=-3.0).vertices - head().vertices).max()
    after = np.linalg.norm(other.vertices - faceless.vertices, axis=1)
    assert before > 5.0
    assert np.percentile(after, 99) < 0.5
