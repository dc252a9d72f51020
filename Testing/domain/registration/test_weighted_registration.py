"""Weighted registration: the fit, its expected FRE and TRE, and the command."""

import json

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rastrainer import transforms
from rastrainer.registration.fits import fit
from rastrainer.registration.localization_error import (
    expected_fre,
    misfit_probability,
    stated_error,
)
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import expected_tre
from rastrainer_simulator.cli.main import main

TARGET = np.array([20.0, -60.0, 35.0])


def fiducials(count=12, seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, (count, 3)) * [90, 60, 40] + [200, -100, 50]


def localization_errors(count=12, seed=1):
    """From 0.3 to 3 mm, RMS length."""
    return np.exp(np.random.default_rng(seed).uniform(np.log(0.3), np.log(3.0), count))


def posed(fixed, seed=2):
    """The points in another frame, and the transform back."""
    true = transforms.rigid(Rotation.random(random_state=seed).as_matrix(), [300, -20, 70])
    return transforms.apply(transforms.inverse(true), fixed), true


def simulated(trials, seed=3, weighted=True):
    """FRE and TRE vectors of many fits with the same fiducials and localization errors."""
    rng = np.random.default_rng(seed)
    fixed, fle = fiducials(), localization_errors()
    exact, true = posed(fixed)
    target = transforms.apply(transforms.inverse(true), (TARGET + fixed.mean(axis=0))[None])
    weights = 1 / fle**2 if weighted else None
    squares, errors = [], []
    for _ in range(trials):
        moving = exact + rng.normal(size=fixed.shape) * fle[:, None] / np.sqrt(3)
        matrix = fit(moving, fixed, "rigid", weights)
        squares.append(np.mean(((transforms.apply(matrix, moving) - fixed) ** 2).sum(axis=1)))
        errors.append(transforms.apply(matrix, target)[0] - TARGET - fixed.mean(axis=0))
    return np.sqrt(np.mean(squares)), np.array(errors)


def weighted_registration(seed=4):
    rng = np.random.default_rng(seed)
    fixed, fle = fiducials(), localization_errors()
    exact, _ = posed(fixed)
    moving = exact + rng.normal(size=fixed.shape) * fle[:, None] / np.sqrt(3)
    return register(moving, fixed, weights=1 / fle**2), fle


def test_the_fit_is_scipys_alignment_of_points_about_their_weighted_centroids():
    rng = np.random.default_rng(5)
    for seed in range(50):
        fixed = fiducials(4 + seed % 12, seed)
        moving = posed(fixed, seed)[0] + rng.normal(size=fixed.shape)
        weights = rng.uniform(0.01, 10, len(fixed))
        a, b = (np.average(points, axis=0, weights=weights) for points in (moving, fixed))
        rotation, _ = Rotation.align_vectors(fixed - b, moving - a, weights=weights)
        matrix = fit(moving, fixed, "rigid", weights)
        np.testing.assert_allclose(matrix[:3, :3], rotation.as_matrix(), atol=1e-9)
        np.testing.assert_allclose(matrix[:3, 3], b - rotation.as_matrix() @ a, atol=1e-7)


def test_expected_fre_and_tre_of_known_unequal_errors_are_those_of_simulated_fits():
    registration, fle = weighted_registration()
    fre, errors = simulated(1500)
    assert expected_fre(registration, stated_error(fle)) == pytest.approx(fre, rel=0.04)
    target = (TARGET + registration.fixed_mm.mean(axis=0))[None]
    expected = expected_tre(registration, target, stated_error(fle), common_bias_sd_mm=0.0)[0]
    assert expected == pytest.approx(np.sqrt((errors**2).sum(axis=1).mean()), rel=0.05)


@pytest.mark.parametrize("sets", [50, pytest.param(400, marks=pytest.mark.soak)])
def test_misfit_to_the_stated_errors_is_seldom_a_false_alarm(sets):
    stated = [misfit_probability(*weighted_registration(seed)) for seed in range(sets)]
    # Give or take three standard errors of so many sets.
    off = 3 * np.sqrt(0.95 * 0.05 / sets)
    assert np.mean(np.array(stated) < 0.05) == pytest.approx(0.05, abs=off)
    registration, fle = weighted_registration()
    assert misfit_probability(registration, fle / 3) < 1e-6


@pytest.fixture
def files(tmp_path):
    """Moving points with a column for FLE, and fixed points in another order."""
    rng = np.random.default_rng(8)
    fixed, fle = fiducials(6), localization_errors(6)
    moving = posed(fixed)[0] + rng.normal(size=fixed.shape) * fle[:, None] / np.sqrt(3)
    moving_file, fixed_file = tmp_path / "moving.csv", tmp_path / "fixed.csv"
    lines = [
        f"p{i},{x},{y},{z},{e}" for i, ((x, y, z), e) in enumerate(zip(moving, fle, strict=True))
    ]
    moving_file.write_text("\n".join(["label,x,y,z,fle", *lines]))
    lines = [f"p{i},{x},{y},{z}" for i, (x, y, z) in reversed(list(enumerate(fixed)))]
    fixed_file.write_text("\n".join(["label,x,y,z", *lines]))
    return moving_file, fixed_file, register(moving, fixed, weights=1 / fle**2), fle


def run(capsys, *words):
    status = main(["register", *map(str, words)])
    return status, capsys.readouterr()


def test_the_command_weights_by_a_column_of_the_points_themselves(files, capsys):
    moving, fixed, expected, fle = files
    status, out = run(capsys, moving, fixed, "--fle", moving, "--json")
    answer = json.loads(out.out)
    assert status == 0
    np.testing.assert_allclose(answer["matrix"], expected.matrix, atol=1e-9)
    np.testing.assert_allclose(answer["weights"], 1 / fle**2, rtol=1e-9)
    assert answer["weighted_fre_mm"] == pytest.approx(expected.weighted_fre_mm)
    assert answer["stated"]["expected_fre_mm"] == pytest.approx(
        expected_fre(expected, stated_error(fle))
    )
    assert answer["expected_tre"]["fle_mm"] == pytest.approx(np.sqrt(np.mean(fle**2)))


def test_the_command_takes_weights_by_label_in_any_order(files, capsys):
    moving, fixed, expected, fle = files
    weights = moving.with_name("weights.csv")
    rows = [f"p{i},{4 / value**2}" for i, value in enumerate(fle)]
    weights.write_text("\n".join(["label,weight", *reversed(rows), "p99,1"]))
    status, out = run(capsys, moving, fixed, "--weights", weights, "--json")
    assert status == 0
    np.testing.assert_allclose(json.loads(out.out)["matrix"], expected.matrix, atol=1e-9)
    assert "Weight" in run(capsys, moving, fixed, "--weights", weights)[1].out


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("label,fle\np0,1\n", "has no fle for point p1, p2"),
        ("label,fle\np0,1\np0,2\n", "two rows for point 'p0'"),
        ("fle\n1\n2\n", "2 rows without labels for 6 pairs"),
    ],
    ids=["missing", "doubled", "too few"],
)
def test_a_file_that_does_not_match_the_points_is_refused_with_a_message(
    files, capsys, text, message
):
    moving, fixed, *_ = files
    path = moving.with_name("fle.csv")
    path.write_text(text)
    status, out = run(capsys, moving, fixed, "--fle", path)
    assert status != 0
    assert message in out.err
