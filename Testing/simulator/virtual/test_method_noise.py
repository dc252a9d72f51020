"""The noise of each method is stated with its source; a scan sees what nothing hides."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, hides
from rastrainer_simulator.virtual.method_trials import RangeCamera
from Testing.domain.registration.traces import colin27


def test_every_scanned_point_lies_on_unoccluded_skin():
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
    off = camera.noisy(seen, np.random.default_rng(1)) - seen
    rays = (seen - camera.eye) / np.linalg.norm(seen - camera.eye, axis=1, keepdims=True)
    along = np.einsum("ij,ij->i", off, rays)
    assert np.allclose(off, along[:, None] * rays)
    assert np.std(along) == pytest.approx(1.0, abs=0.15)


def test_a_camera_that_sees_too_little_is_refused_with_a_message():
    head = colin27()
    with pytest.raises(InputError, match="range camera sees"):
        RangeCamera(head.middle + np.array([0.0, 500.0, 0.0]), 1.0, spacing_mm=90.0).seen(head)


def test_a_ray_that_misses_the_surface_hits_nothing():
    corners = np.array([[0.0, 0, 0], [100, 0, 0], [0, 100, 0], [0, 0, 100]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    seen = RangeCamera(np.array([300.0, 300.0, 300.0]), 0.0, 4.0).seen(HeadMesh(corners, faces))
    assert np.allclose(seen.sum(axis=1), 100.0)
    assert (seen > -1e-9).all()
