"""The estimate of the bias that all touches of a trial share."""

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.target_error import common_bias, true_touch_errors
from Testing.touched_head import head_points, random_rotation


def skin(rng, count=15):
    """Normals of the upper half of a head."""
    normals = head_points(rng, count) / np.array([75.0, 95.0, 85.0]) ** 2
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def along_skin(errors, normals):
    return errors - normals * np.einsum("...ij,ij->...i", errors, normals)[..., None]


@pytest.mark.parametrize("seed", range(12))
def test_a_bias_is_recovered_whatever_part_of_it_points_away_from_the_skin(seed):
    rng = np.random.default_rng(seed)
    normals, bias = skin(rng), rng.normal(0.0, 2.0, 3)
    depth = normals * rng.normal(0.0, 3.0, (15, 1))
    for errors in (along_skin(np.tile(bias, (15, 1)), normals), bias + depth):
        found = common_bias(errors, normals)
        assert found.vector_mm == pytest.approx(bias, abs=1e-9)
        assert found.is_shown


@pytest.mark.parametrize("seed", range(12))
def test_the_bias_is_the_least_squares_solution_and_rotates_with_the_head(seed):
    rng = np.random.default_rng(seed)
    normals, errors = skin(rng), rng.normal(0.0, 1.0, (15, 3))
    found = common_bias(errors, normals)
    along = np.eye(3) - normals[:, :, None] * normals[:, None, :]
    expected = np.linalg.lstsq(along.reshape(45, 3), (along @ errors[..., None]).ravel())[0]
    assert found.vector_mm == pytest.approx(expected, abs=1e-9)
    turn = random_rotation(rng)
    turned = common_bias(errors @ turn.T, normals @ turn.T)
    assert turned.vector_mm == pytest.approx(turn @ expected, abs=1e-9)
    assert turned.p == pytest.approx(found.p, abs=1e-9)


def test_p_values_of_unbiased_errors_are_uniform_and_a_bias_of_a_millimeter_is_detected():
    rng = np.random.default_rng(3)
    normals = skin(rng)
    noise = along_skin(rng.normal(0.0, 0.7, (400, 15, 3)), normals)
    p = np.sort([common_bias(errors, normals).p for errors in noise])
    # Kolmogorov's distance, whose 99.9 % quantile is 1.95/sqrt(n).
    assert np.abs(p - np.arange(1, 401) / 400).max() < 1.95 / np.sqrt(400)
    assert np.mean(p < 0.05) == pytest.approx(0.05, abs=0.035)
    biased = noise + along_skin(np.tile([0.0, 1.0, 0.0], (15, 1)), normals)
    assert np.mean([common_bias(errors, normals).is_shown for errors in biased]) > 0.95


@pytest.mark.parametrize(("bias", "p"), [((0.0, 0.0, 0.0), 1.0), ((3.0, 0.0, 4.0), 0.0)])
def test_errors_without_scatter_show_any_bias_and_zero_errors_show_none(bias, p):
    normals = skin(np.random.default_rng(6))
    found = common_bias(along_skin(np.tile(bias, (15, 1)), normals), normals)
    assert found.p == pytest.approx(p, abs=1e-9)
    assert found.length_mm == pytest.approx(np.linalg.norm(bias), abs=1e-9)


def test_true_errors_are_expressed_in_the_head_frame():
    rng = np.random.default_rng(7)
    fiducials, errors = head_points(rng), rng.normal(0.0, 1.0, (15, 3))
    pose = transforms.rigid(random_rotation(rng), rng.uniform(-500.0, 500.0, 3))
    touches = transforms.apply(pose, fiducials + errors)
    assert true_touch_errors(touches, pose, fiducials) == pytest.approx(errors, abs=1e-9)


def test_an_invalid_pose_is_refused_with_a_message():
    with pytest.raises(InputError, match="must be a rigid transform"):
        true_touch_errors(np.zeros((3, 3)), np.zeros((4, 4)), np.zeros((3, 3)))
