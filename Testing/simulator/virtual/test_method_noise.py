"""The noise of methods of registration."""

import numpy as np
import pytest

from rastrainer_simulator.virtual.method_trials import RangeCamera
from Testing.domain.registration.traces import colin27


def test_the_noise_of_a_scan_lies_along_its_rays():
    head = colin27()
    camera = RangeCamera(head.middle + np.array([0.0, 500.0, 0.0]), 1.0)
    seen = camera.seen(head)
    off = camera.noisy(seen, np.random.default_rng(1)) - seen
    rays = (seen - camera.eye) / np.linalg.norm(seen - camera.eye, axis=1, keepdims=True)
    along = np.einsum("ij,ij->i", off, rays)
    assert np.allclose(off, along[:, None] * rays)
    assert np.std(along) == pytest.approx(1.0, abs=0.15)
