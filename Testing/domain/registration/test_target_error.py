"""The interval of the expected TRE contains the true TRE, also if touches share an offset."""

import numpy as np
import pytest
from scipy import stats
from scipy.spatial.transform import Rotation

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.distributions import (
    widened_distribution,
    widened_quantile,
)
from rastrainer.registration.fits import fit
from rastrainer.registration.localization_error import error_along_surface, isotropic_error
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import (
    COMMON_BIAS_SD_MM,
    common_bias,
    expected_tre,
    target_error,
    true_errors,
    true_touch_errors,
)
from Testing.touched_head import head_points, random_rotation

TILT = Rotation.from_euler("xyz", [25, -40, 70], degrees=True).as_matrix()


def fiducials(count, seed=0):
    """An elongated, tilted set far from the origin."""
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, 3)) * [90, 60, 30] @ TILT.T + [400, -250, 120]


def simulated(fixed, target, kind, deviation, trials, seed=1):
    """FRE and length of TRE of many noisy registrations with a known transform."""
    rng = np.random.default_rng(seed)
    true = transforms.rigid(Rotation.random(random_state=seed).as_matrix(), [10, 700, -40])
    exact = transforms.apply(transforms.inverse(true), fixed)
    target_moving = transforms.apply(transforms.inverse(true), target)
    fre, tre = np.empty(trials), np.empty(trials)
    for i in range(trials):
        moving = exact + rng.normal(size=fixed.shape) * deviation
        matrix = fit(moving, fixed, kind)
        fre[i] = np.sqrt(((transforms.apply(matrix, moving) - fixed) ** 2).sum(axis=1).mean())
        tre[i] = np.linalg.norm(transforms.apply(matrix, target_moving) - target)
    return fre, tre


def noisy(fixed, kind="rigid", seed=2):
    rng = np.random.default_rng(seed)
    return register(fixed + rng.normal(size=fixed.shape) * 0.8, fixed, kind)


def eq_46(fixed, target, fle_mm):
    """Fitzpatrick 1998, equation 46, term by term along the principal axes."""
    centered = fixed - fixed.mean(axis=0)
    axes = np.linalg.svd(centered)[2]
    total = 1.0
    for axis in axes:
        f2 = np.mean(np.linalg.norm(np.cross(centered, axis), axis=1) ** 2)
        d2 = np.linalg.norm(np.cross(target - fixed.mean(axis=0), axis)) ** 2
        total += d2 / f2 / 3
    return fle_mm * np.sqrt(total / len(fixed))


def test_rigid_expectation_is_fitzpatricks_equation_46():
    fixed = fiducials(15)
    registration = noisy(fixed)
    targets = np.random.default_rng(3).normal(size=(20, 3)) * 100 + fixed.mean(axis=0)
    expected = [eq_46(fixed, target, isotropic_error(registration).fle_mm) for target in targets]
    without_offset = expected_tre(registration, targets, common_bias_sd_mm=0.0)
    np.testing.assert_allclose(without_offset, expected, rtol=1e-10)


@pytest.mark.parametrize("kind", ["similarity", "affine"])
def test_expectation_agrees_with_simulation_off_the_origin_and_tilted(kind):
    fixed = fiducials(8)
    target = np.array([70, -50, 40]) + fixed.mean(axis=0)
    fre, tre = simulated(fixed, target, kind, deviation=0.5, trials=800)
    registration = noisy(fixed, kind)
    expected = expected_tre(registration, target[None], common_bias_sd_mm=0.0)[0]
    per_fle = expected / isotropic_error(registration).fle_mm
    assert np.sqrt(np.mean(tre**2)) == pytest.approx(per_fle * 0.5 * np.sqrt(3), rel=0.05)
    fle = fre * isotropic_error(registration).fle_mm / registration.fre_mm
    assert np.sqrt(np.mean(fle**2)) == pytest.approx(0.5 * np.sqrt(3), rel=0.05)


def ball_cap(count, seed):
    """Fiducials on one side of a ball of 90 mm about the origin, with their normals."""
    rng = np.random.default_rng(seed)
    normals = rng.normal(size=(count, 3)) * 0.45 + [0.0, 1.0, 0.0]
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return 90.0 * normals, normals


def slipping(normals, along, across, rng):
    """Errors of touches stopped by the skin: `along` and `across` it, mm per coordinate."""
    errors = rng.normal(size=normals.shape) * along
    part = (errors * normals).sum(axis=1)
    return errors + (rng.normal(size=len(normals)) * across - part)[:, None] * normals


def test_the_parts_of_the_localization_error_along_and_across_the_skin_are_recovered():
    along, across = 0.8, 0.2
    rng = np.random.default_rng(5)
    found = []
    for seed in range(40):
        fixed, normals = ball_cap(15, seed)
        registration = register(fixed + slipping(normals, along, across, rng), fixed)
        covariances = error_along_surface(registration, normals).covariances
        variance_across = np.einsum("ni,nij,nj->n", normals, covariances, normals)
        total = np.trace(covariances, axis1=1, axis2=2)
        found.append([variance_across.mean(), (total - variance_across).mean() / 2])
    variances = np.mean(found, axis=0)
    np.testing.assert_allclose(np.sqrt(variances), [across, along], rtol=0.1)


@pytest.mark.parametrize("sets", [20, pytest.param(120, marks=pytest.mark.soak)])
@pytest.mark.parametrize("kind", ["rigid", pytest.param("affine", marks=pytest.mark.soak)])
def test_the_interval_holds_the_true_error_of_touches_that_slip_along_the_skin(kind, sets):
    rng = np.random.default_rng(6)
    target = np.zeros(3)
    inside = 0
    for seed in range(sets):
        fixed, normals = ball_cap(15, seed)
        registration = register(fixed + slipping(normals, 0.8, 0.1, rng), fixed, kind)
        true_mm = np.linalg.norm(transforms.apply(registration.matrix, target) - target)
        error = target_error(registration, target, error_along_surface(registration, normals))
        inside += error.interval_mm[0] <= true_mm <= error.interval_mm[1]
    # The tolerance is two and a half standard errors.
    assert inside / sets >= 0.95 - 2.5 * np.sqrt(0.95 * 0.05 / sets)


def test_an_exact_affine_fit_of_four_points_gives_no_estimate():
    fixed = fiducials(4)
    with pytest.raises(InputError, match=r"Any 4 pairs of points fit .* affine exactly"):
        target_error(noisy(fixed, "affine"), fixed[0])


def test_the_true_error_is_the_displacement_of_a_point_by_the_registration():
    head_to_world = transforms.rigid(TILT, [10, 700, -40])
    found = transforms.rigid(np.eye(3), [0.3, 0.0, -0.4]) @ transforms.inverse(head_to_world)
    errors = true_errors(found, head_to_world, fiducials(4))
    np.testing.assert_allclose(errors, np.tile([0.3, 0.0, -0.4], (4, 1)), atol=1e-9)


ASIDE = np.array([30.0, -20.0, 40.0])


def touched(seed, offset=0.0, count=15, sd=0.5, kind="rigid"):
    rng = np.random.default_rng(seed)
    fixed = fiducials(count)
    return register(fixed + rng.normal(size=fixed.shape) * sd + offset, fixed, kind)


def test_the_common_offset_adds_in_quadrature_to_independent_errors():
    registration = touched(2)
    error = target_error(registration, ASIDE)
    without = target_error(registration, ASIDE, common_bias_sd_mm=0.0)
    assert error.independent_mm == pytest.approx(without.expected_mm)
    assert error.expected_mm == pytest.approx(
        np.sqrt(without.expected_mm**2 + 3 * COMMON_BIAS_SD_MM**2)
    )
    assert expected_tre(registration, ASIDE[None])[0] == pytest.approx(error.expected_mm)


def test_a_perfect_fit_still_expects_the_common_offset():
    fixed = fiducials(15)
    error = target_error(register(fixed, fixed), ASIDE)
    assert error.expected_mm == pytest.approx(np.sqrt(3) * COMMON_BIAS_SD_MM)
    assert error.interval_mm[0] == pytest.approx(0.0, abs=1e-9)
    largest = COMMON_BIAS_SD_MM * np.sqrt(stats.chi2(3).ppf(0.95))
    assert error.interval_mm[1] == pytest.approx(largest, rel=1e-5)


@pytest.mark.parametrize(
    ("weights", "dof", "added"),
    [
        ((0.1, 0.02, 0.005), 39.0, 0.0625),
        ((1.0, 1.0, 1.0), 3.0, 0.0625),
        ((10.0, 0.001, 0.0), 6.0, 0.0625),
        ((0.3, 0.1, 0.05), np.inf, 0.02),
        ((0.0, 0.0, 0.0), 9.0, 0.04),
    ],
    ids=["head", "three points", "one axis", "known", "offset alone"],
)
def test_quantiles_are_those_of_simulated_lengths(weights, dof, added):
    rng = np.random.default_rng(5)
    count = 100_000
    scale = 1.0 if np.isinf(dof) else dof / rng.chisquare(dof, (count, 1))
    squares = ((np.array(weights) * scale + added) * rng.normal(size=(count, 3)) ** 2).sum(axis=1)
    for probability in (0.5, 0.95, 0.975):
        found = widened_quantile(probability, np.array(weights), dof, added)
        # Four standard errors.
        off = 4 * np.sqrt(probability * (1 - probability) / count)
        assert np.mean(squares <= found) == pytest.approx(probability, abs=off)
        again = widened_distribution(np.array(weights), dof, added)(found)
        assert again == pytest.approx(probability, abs=1e-6)


def skin(rng, count=15):
    """Normals of the upper half of a head."""
    normals = head_points(rng, count) / np.array([75.0, 95.0, 85.0]) ** 2
    return normals / np.linalg.norm(normals, axis=1, keepdims=True)


def along_skin(errors, normals):
    return errors - normals * np.einsum("...ij,ij->...i", errors, normals)[..., None]


@pytest.mark.parametrize("seed", range(3))
def test_the_bias_is_the_least_squares_solution_and_rotates_with_the_head(seed):
    rng = np.random.default_rng(seed)
    normals, bias = skin(rng), rng.normal(0.0, 2.0, 3)
    # Errors across the skin do not count.
    depth = normals * rng.normal(0.0, 3.0, (15, 1))
    exact = common_bias(bias + depth, normals)
    assert exact.vector_mm == pytest.approx(bias, abs=1e-9)
    assert exact.is_shown
    errors = rng.normal(0.0, 1.0, (15, 3))
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


def test_true_errors_are_expressed_in_the_head_frame():
    rng = np.random.default_rng(7)
    fiducials, errors = head_points(rng), rng.normal(0.0, 1.0, (15, 3))
    pose = transforms.rigid(random_rotation(rng), rng.uniform(-500.0, 500.0, 3))
    touches = transforms.apply(pose, fiducials + errors)
    assert true_touch_errors(touches, pose, fiducials) == pytest.approx(errors, abs=1e-9)
