"""The expected target error agrees with Fitzpatrick's formula and holds the true error."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.fits import fit
from rastrainer.registration.localization_error import error_along_surface, isotropic_error
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import expected_tre, target_error, true_errors

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


@pytest.mark.parametrize(
    ("kind", "count", "offset"),
    [
        ("rigid", 3, [40, 20, 10]),
        ("affine", 8, [40, -60, 20]),
    ],
)
def test_the_interval_holds_the_true_error_in_95_of_100_trials(kind, count, offset):
    fixed = fiducials(count, seed=4)
    target = np.array(offset) + fixed.mean(axis=0)
    fre, tre = simulated(fixed, target, kind, deviation=0.4, trials=800)
    registration = noisy(fixed, kind)
    error = target_error(registration, target, common_bias_sd_mm=0.0)
    low, high = np.array(error.interval_mm) / registration.fre_mm
    inside = (low * fre <= tre) & (tre <= high * fre)
    assert 0.92 <= inside.mean() <= 0.98
    assert 0.005 <= (tre < low * fre).mean() <= 0.045


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


@pytest.mark.parametrize("sets", [40, pytest.param(100, marks=pytest.mark.soak)])
@pytest.mark.parametrize(
    ("along", "across"), [(0.8, 0.2), pytest.param(0.2, 0.9, marks=pytest.mark.soak)]
)
def test_the_parts_of_the_localization_error_along_and_across_the_skin_are_recovered(
    along, across, sets
):
    rng = np.random.default_rng(5)
    found = []
    for seed in range(sets):
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
    # Give or take two and a half standard errors of so many sets.
    assert inside / sets >= 0.95 - 2.5 * np.sqrt(0.95 * 0.05 / sets)


@pytest.mark.parametrize("normals", [np.eye(3), 2.0 * np.ones((8, 3)), np.full((8, 3), np.nan)])
def test_invalid_normals_are_refused(normals):
    with pytest.raises(InputError, match="8 normals of length 1"):
        error_along_surface(noisy(fiducials(8)), normals)


def test_a_perfect_fit_without_a_common_offset_expects_no_error():
    fixed = fiducials(5)
    error = target_error(register(fixed, fixed), fixed[0], common_bias_sd_mm=0.0)
    assert error.expected_mm == pytest.approx(0.0, abs=1e-9)
    assert error.interval_mm == pytest.approx((0.0, 0.0), abs=1e-9)


def test_an_exact_affine_fit_of_four_points_gives_no_estimate():
    fixed = fiducials(4)
    with pytest.raises(InputError, match=r"Any 4 pairs of points fit .* affine exactly"):
        target_error(noisy(fixed, "affine"), fixed[0])


@pytest.mark.parametrize("target", [[1, 2], [1, 2, np.nan], [np.inf, 0, 0]])
def test_a_target_must_be_a_point(target):
    with pytest.raises(InputError, match="three finite coordinates"):
        target_error(noisy(fiducials(5)), target)


def test_the_true_error_is_the_displacement_of_a_point_by_the_registration():
    head_to_world = transforms.rigid(TILT, [10, 700, -40])
    found = transforms.rigid(np.eye(3), [0.3, 0.0, -0.4]) @ transforms.inverse(head_to_world)
    errors = true_errors(found, head_to_world, fiducials(4))
    np.testing.assert_allclose(errors, np.tile([0.3, 0.0, -0.4], (4, 1)), atol=1e-9)
