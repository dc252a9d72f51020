"""A scan sees what nothing hides; a shift of the skin is smooth, seeded, and none at the base."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.skin_shift import SkinShift
from rastrainer.head.surface_queries import hides
from rastrainer.registration.methods import RegistrationMethod
from rastrainer.registration.published_noise import PUBLISHED_NOISE
from rastrainer.registration.range_camera import RangeCamera
from Testing.domain.registration.traces import colin27


def test_every_scanned_point_lies_on_skin_that_nothing_hides():
    head = colin27()
    camera = RangeCamera(head.middle + np.array([250.0, 400.0, 50.0]), 1.0, spacing_mm=16.0)
    seen = camera.seen(head)
    assert len(seen) > 80
    assert head.skin.tree.nearest(seen).distances.max() < 1e-6
    assert not any(hides(head, camera.eye, point) for point in seen[::4])
    assert seen[:, 0].min() > head.vertices[:, 0].min() + 20.0


def test_the_noise_of_a_scan_lies_along_its_rays():
    head = colin27()
    camera = RangeCamera(head.middle + np.array([0.0, 500.0, 0.0]), 1.0)
    seen = camera.seen(head)
    off = camera.scan(head, np.random.default_rng(1)) - seen
    rays = (seen - camera.eye) / np.linalg.norm(seen - camera.eye, axis=1, keepdims=True)
    along = np.einsum("ij,ij->i", off, rays)
    assert np.allclose(off, along[:, None] * rays)
    assert np.std(along) == pytest.approx(1.0, abs=0.15)


def test_a_camera_that_sees_too_little_gets_a_sentence():
    head = colin27()
    with pytest.raises(InputError, match="range camera sees"):
        RangeCamera(head.middle + np.array([0.0, 500.0, 0.0]), 1.0, spacing_mm=90.0).seen(head)


def test_a_shift_has_its_size_is_smooth_and_ends_at_the_base():
    head = colin27()
    high = head.vertices[head.vertices[:, 2] > head.vertices[:, 2].min() + 30.0][::40]
    squares = [np.sum(SkinShift(2.0, seed).moved(high, head) ** 2, axis=1) for seed in range(60)]
    assert np.sqrt(np.mean(squares)) == pytest.approx(2.0, abs=0.15)
    shift = SkinShift(2.0, 7)
    moved, beside = shift.moved(high, head), shift.moved(high + np.array([3.0, 0.0, 0.0]), head)
    assert np.linalg.norm(moved - beside, axis=1).max() < 0.5
    assert np.array_equal(moved, SkinShift(2.0, 7).moved(high, head))
    assert not np.allclose(moved, SkinShift(2.0, 8).moved(high, head))
    assert not shift.moved(np.array([[0.0, 0.0, head.vertices[:, 2].min()]]), head).any()


def test_by_default_nothing_moves_and_the_tip_presses_inward():
    head, rows = colin27(), slice(0, 2000, 50)
    points, normals = head.vertices[rows], head.vertex_normals[rows]
    assert np.array_equal(SkinShift().touched(points, normals, head), points)
    pressed = SkinShift(indentation_mm=1.5).touched(points, normals, head)
    assert np.allclose(pressed, points - 1.5 * normals)
    with pytest.raises(InputError, match="0 to 20 mm"):
        SkinShift(-1.0)


def test_noise_is_stated_with_its_source_for_every_method_and_screws_are_off_the_skin():
    assert set(PUBLISHED_NOISE) == set(RegistrationMethod)
    assert all(noise.point_mm > 0 and noise.source for noise in PUBLISHED_NOISE.values())
    screws, markers, landmarks = (
        PUBLISHED_NOISE[method]
        for method in (
            RegistrationMethod.BONE_SCREWS,
            RegistrationMethod.FIDUCIALS,
            RegistrationMethod.LANDMARKS,
        )
    )
    assert screws.point_mm < markers.point_mm < landmarks.point_mm
    assert not screws.is_on_skin
    assert markers.is_on_skin


def test_a_ray_beside_the_surface_meets_nothing():
    corners = np.array([[0.0, 0, 0], [100, 0, 0], [0, 100, 0], [0, 0, 100]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    seen = RangeCamera(np.array([300.0, 300.0, 300.0]), 0.0, 4.0).seen(HeadMesh(corners, faces))
    assert np.allclose(seen.sum(axis=1), 100.0)
    assert (seen > -1e-9).all()
