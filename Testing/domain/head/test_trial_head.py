"""A shift of the skin is smooth, seeded, and none at the base."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.trial_head import SkinShift
from Testing.domain.registration.traces import colin27


def test_a_shift_has_the_requested_size_is_smooth_and_vanishes_at_the_base():
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


def test_by_default_nothing_moves_and_an_indentation_points_inward():
    head, rows = colin27(), slice(0, 2000, 50)
    points, normals = head.vertices[rows], head.vertex_normals[rows]
    assert np.array_equal(SkinShift().touched(points, normals, head), points)
    pressed = SkinShift(indentation_mm=1.5).touched(points, normals, head)
    assert np.allclose(pressed, points - 1.5 * normals)
    with pytest.raises(InputError, match="0 to 20 mm"):
        SkinShift(-1.0)
