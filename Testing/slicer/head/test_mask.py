"""Morphology of the head's voxels, against SciPy's exact and slow distances."""

import numpy as np
import pytest
from scipy import ndimage

from rastrainer.slicer.head import mask
from rastrainer.slicer.head.mask import carved
from rastrainer.slicer.head.surface import meshOf, surfaceOf

BODY = ndimage.gaussian_filter(np.random.default_rng(2).normal(size=(34, 40, 28)), 2.0) > -0.02


@pytest.mark.parametrize("body", [BODY, BODY.transpose(2, 0, 1)], ids=["C order", "transposed"])
def test_depths_are_exact_within_the_requested_distance(body):
    below = np.pad(body, [(0, 0), (0, 0), (9, 0)], mode="edge")
    exact = ndimage.distance_transform_edt(below)[:, :, 9:]
    depth = mask.depthInside(body, 4.0)
    assert (exact > 4.0).any()
    assert np.allclose(depth[exact <= 4.0], exact[exact <= 4.0], atol=1e-5)
    assert (depth[exact > 4.0] > 4.0).all()


def test_a_closing_fills_whatever_no_ball_outside_can_reach():
    closed = mask.closedByBall(BODY, 3.0)
    padded = np.pad(BODY, [(9, 9), (9, 9), (0, 9)])
    padded = np.pad(padded, [(0, 0), (0, 0), (9, 0)], mode="edge")
    centers = ndimage.distance_transform_edt(~padded) > 3.0
    reached = ndimage.distance_transform_edt(~centers) <= 3.0
    assert np.array_equal(closed, ~reached[9:-9, 9:-9, 9:-9])
    assert closed.sum() > BODY.sum()


def ball(radius, size=31):
    grid = np.indices((size,) * 3) - size // 2
    return np.sqrt((grid**2).sum(axis=0)) <= radius


def euler_characteristic(body):
    return meshOf(surfaceOf(np.where(body, 1.0, -1.0), np.zeros(3), 1.0)).euler_characteristic


def with_tunnel(width):
    body = ball(11)
    body[:, 15 - width : 16 + width, 15 - width : 16 + width] = False
    return body


@pytest.mark.parametrize("width", [0, 3])
def test_a_tunnel_is_closed_by_one_thin_membrane(width):
    wanted = with_tunnel(width)
    assert euler_characteristic(wanted) == 0
    result = carved(ball(11), wanted)
    assert euler_characteristic(result) == 2
    membrane = result & ~wanted
    assert (2 * width + 1) ** 2 <= membrane.sum() <= 2 * (2 * width + 1) ** 2
    assert not (wanted & ~result).any()


def test_a_membrane_lies_where_the_tunnel_is_narrow():
    wanted = ball(11)
    wanted[:, 12:19, 12:19] = False
    wanted[9:12] |= ball(11)[9:12]
    wanted[9:12, 15, 15] = False
    membrane = carved(ball(11), wanted) & ~wanted
    assert 1 <= membrane.sum() <= 3
    assert set(np.argwhere(membrane)[:, 0]) <= {9, 10, 11}


def test_a_body_without_tunnels_is_carved_exactly():
    wanted = ball(9)
    wanted[15:] &= ball(6)[15:]
    assert np.array_equal(carved(ball(12), wanted), wanted)


def test_noise_never_leaves_a_tunnel():
    rng = np.random.default_rng(5)
    rough = ndimage.gaussian_filter(rng.normal(size=(31, 31, 31)), 1.2)
    wanted = ball(10) & (rough > -0.05)
    wanted[15, 15, 15] = True
    labels, _ = ndimage.label(wanted)
    wanted = labels == np.bincount(labels.ravel())[1:].argmax() + 1
    assert euler_characteristic(wanted) < 0
    assert euler_characteristic(carved(ball(11), wanted)) == 2
