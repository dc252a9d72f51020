"""The expected TRE allows for an offset common to all touches."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from rastrainer.registration.distributions import (
    ratio_quantile,
    widened_distribution,
    widened_quantile,
)
from rastrainer.registration.registration import register
from rastrainer.registration.target_error import (
    COMMON_BIAS_SD_MM,
    INTERVAL_NOTE,
    expected_tre,
    target_error,
)
from rastrainer_simulator.cli.main import main

TARGET = np.array([30.0, -20.0, 40.0])


def fiducials(count=15, seed=0):
    return np.random.default_rng(seed).uniform(-1, 1, (count, 3)) * [90, 70, 60]


def touched(seed, offset=0.0, count=15, sd=0.5, kind="rigid"):
    rng = np.random.default_rng(seed)
    fixed = fiducials(count)
    return register(fixed + rng.normal(size=fixed.shape) * sd + offset, fixed, kind)


def test_the_common_offset_adds_in_quadrature_to_independent_errors():
    registration = touched(2)
    error = target_error(registration, TARGET)
    without = target_error(registration, TARGET, common_bias_sd_mm=0.0)
    assert error.independent_mm == pytest.approx(without.expected_mm)
    assert error.expected_mm == pytest.approx(
        np.sqrt(without.expected_mm**2 + 3 * COMMON_BIAS_SD_MM**2)
    )
    assert expected_tre(registration, TARGET[None])[0] == pytest.approx(error.expected_mm)


def test_a_perfect_fit_still_expects_the_common_offset():
    fixed = fiducials()
    error = target_error(register(fixed, fixed), TARGET)
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


@pytest.mark.parametrize("dof", [2, 39, 2994])
def test_the_quantile_of_equally_weighted_squares_is_that_of_f(dof):
    for probability in (0.001, 0.5, 0.975, 0.999):
        expected = 3 * stats.f.ppf(probability, 3, dof)
        assert ratio_quantile(probability, np.ones(3), dof) == pytest.approx(expected, rel=1e-6)


def test_without_an_offset_the_quantile_is_that_of_the_ratio():
    weights = np.array([0.1, 0.05, 0.02])
    for probability in (0.025, 0.5, 0.975):
        assert widened_quantile(probability, weights, 39, 0.0) == pytest.approx(
            ratio_quantile(probability, weights, 39), rel=1e-4
        )
    equal = widened_quantile(0.975, np.full(3, 0.2), 12, 0.0)
    assert equal == pytest.approx(0.6 * stats.f(3, 12).ppf(0.975), rel=1e-4)


def test_the_command_prints_the_note_beside_the_error(tmp_path: Path, capsys):
    path = tmp_path / "points.csv"
    rows = [f"{i},{x},{y},{z}" for i, (x, y, z) in enumerate(fiducials(6), start=1)]
    path.write_text("\n".join(["label,x,y,z", *rows]))
    assert main(["register", str(path), str(path)]) == 0
    assert INTERVAL_NOTE in capsys.readouterr().out
    assert main(["register", str(path), str(path), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["expected_tre"]["note"] == INTERVAL_NOTE
    assert f"{COMMON_BIAS_SD_MM:g} mm" in INTERVAL_NOTE
