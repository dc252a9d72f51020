"""Morphology of the head's voxels, against SciPy's exact and slow distances."""

import numpy as np
import pytest
from scipy import ndimage

from rastrainer.slicer.head import mask

BODY = ndimage.gaussian_filter(np.random.default_rng(2).normal(size=(34, 40, 28)), 2.0) > -0.02


@pytest.mark.parametrize("body", [BODY, BODY.transpose(2, 0, 1)], ids=["C order", "transposed"])
def test_depths_are_exact_as_far_as_they_are_asked_for(body):
    below = np.pad(body, [(0, 0), (0, 0), (9, 0)], mode="edge")
    exact = ndimage.distance_transform_edt(below)[:, :, 9:]
    depth = mask.depthInside(body, 4.0)
    assert (exact > 4.0).any()
    assert np.allclose(depth[exact <= 4.0], exact[exact <= 4.0], atol=1e-5)
    assert (depth[exact > 4.0] > 4.0).all()


def test_a_closing_fills_what_no_ball_outside_reaches():
    closed = mask.closedByBall(BODY, 3.0)
    padded = np.pad(BODY, [(9, 9), (9, 9), (0, 9)])
    padded = np.pad(padded, [(0, 0), (0, 0), (9, 0)], mode="edge")
    centers = ndimage.distance_transform_edt(~padded) > 3.0
    reached = ndimage.distance_transform_edt(~centers) <= 3.0
    assert np.array_equal(closed, ~reached[9:-9, 9:-9, 9:-9])
    assert closed.sum() > BODY.sum()
