"""Motion metrics agree with published values or values computed by hand."""

import numpy as np
import pytest
import scipy.signal

from rastrainer.errors import InputError
from rastrainer.motion import trajectory
from rastrainer.motion.trial_motion import effective_throughput

RATE_HZ = 100.0
BELL = np.exp(-5 * np.arange(-1, 1, 0.01) ** 2)


TAPS = """
    218.5 263  529.5 268  195.0 248  533.5 234  209.8 251  607.0 253  231.3 283
    540.8 215  231.9 301  560.5 267  207.5 259  524.5 259  239.1 248  515.0 243
    180.0 242  501.0 253  215.5 244  572.0 256  215.4 252  521.5 210
"""
"""The example of MacKenzie's class Throughput (2013-2016): where each tap went, and its time in ms;
from x = 540.2 to 227.8 and back."""


def test_sparc_matches_its_authors_own_example():
    """Balasubramanian et al. 2015, their program's example: fc 10 Hz, threshold 0.05, padding 4."""
    assert trajectory.sparc(BELL, RATE_HZ) == pytest.approx(-1.41403, abs=5e-6)


def test_log_dimensionless_jerk_matches_its_authors_own_example():
    """Balasubramanian et al. 2015, their program's examples, with and without the logarithm."""
    assert trajectory.log_dimensionless_jerk(BELL, RATE_HZ) == pytest.approx(-5.81636, abs=5e-6)
    assert np.exp(-trajectory.log_dimensionless_jerk(BELL, RATE_HZ)) == pytest.approx(
        335.74684, abs=5e-6
    )


def test_log_dimensionless_jerk_of_a_minimum_jerk_reach_is_the_analytical_one():
    """From Flash and Hogan 1985: 720 over the square of the peak speed 15/8 gives −ln 204.8."""
    t = np.linspace(0, 1, 20_001)
    speed = 30 * t**2 - 60 * t**3 + 30 * t**4
    assert trajectory.log_dimensionless_jerk(speed, 20_000) == pytest.approx(-5.322, abs=1e-3)


@pytest.mark.parametrize("smoothness", [trajectory.sparc, trajectory.log_dimensionless_jerk])
def test_smoothness_does_not_depend_on_size_and_falls_with_submovements(smoothness):
    halting = BELL * (1 + 0.5 * np.sin(np.linspace(0, 40, len(BELL))))
    assert smoothness(BELL * 7, RATE_HZ) == pytest.approx(smoothness(BELL, RATE_HZ))
    assert smoothness(halting, RATE_HZ) < smoothness(BELL, RATE_HZ) - 0.1


@pytest.mark.parametrize("speed", [np.zeros(50), np.ones(3), np.full(50, np.nan)])
def test_smoothness_without_movement_is_refused(speed):
    for smoothness in (trajectory.sparc, trajectory.log_dimensionless_jerk):
        with pytest.raises(InputError, match="at least four samples"):
            smoothness(speed, RATE_HZ)


def test_low_pass_agrees_with_scipys_zero_phase_butterworth():
    rng = np.random.default_rng(0)
    t = np.arange(0, 10, 1 / RATE_HZ)
    values = np.column_stack([np.sin(2 * np.pi * t), 50 * t + rng.normal(size=len(t))])
    expected = scipy.signal.sosfiltfilt(
        scipy.signal.butter(2, 6.0, fs=RATE_HZ, output="sos"), values, axis=0
    )
    difference = trajectory.low_pass(values, RATE_HZ, 6.0) - expected
    assert np.abs(difference[50:-50]).max() < 0.05


def test_path_length_and_efficiency():
    # A helix of radius r and pitch p is 2π√(r² + (p/2π)²) long a turn (do Carmo 1976, § 1-3).
    turn = np.linspace(0.0, 2.0 * np.pi, 20_001)
    helix = np.column_stack([40.0 * np.cos(turn), 40.0 * np.sin(turn), 30.0 * turn])
    assert trajectory.path_length(helix) == pytest.approx(2.0 * np.pi * 50.0, rel=1e-7)
    square = np.array([[0, 0, 0], [10, 0, 0], [10, 10, 0], [0, 10, 0]], dtype=float)
    assert trajectory.path_length(square) == 30.0


def test_throughput_follows_iso_9241_411_along_the_task_axis_about_the_targets():
    targets = np.array([[0, 0, 0], [100, 0, 0], [100, 60, 0], [100, 60, 80]], dtype=float)
    touches = targets + np.array([[0, 0, 0], [1, 5, 5], [5, -1, 5], [5, 5, 3]])
    result = effective_throughput(targets, touches, np.array([0.0, 2.0, 3.0, 5.0]))
    width = 4.133 * np.sqrt(np.mean(np.square([1, -1, 3])))
    distances = np.array([101.0, 54.0, 78.0])
    difficulties = np.log2(distances / width + 1)
    assert result.effective_width_mm == pytest.approx(width)
    np.testing.assert_allclose(result.effective_distances_mm, distances)
    assert result.bits_per_s == pytest.approx(np.mean(difficulties / [2.0, 1.0, 2.0]))


def test_throughput_matches_mackenzies_own_example():
    """MacKenzie, class Throughput: We 106.06, Ae 327.06, IDe 2.030 bits, MT 252.3 ms, 8.044 bits/s.

    He takes the deviation from the mean end point, with n − 1, and divides the mean difficulty by
    the mean time; we take the distance from the target and the mean of each movement's ratio.
    """
    taps = np.array(TAPS.split(), dtype=float).reshape(20, 2)
    at_x = np.tile([540.2, 227.8], 11)[:21]
    targets = np.column_stack([at_x, np.zeros((21, 2))])
    touches = np.column_stack([[540.2, *taps[:, 0]], np.zeros((21, 2))])
    result = effective_throughput(targets, touches, np.cumsum([0.0, *taps[:, 1] / 1000.0]))
    beside = (touches - targets)[1:, 0] * np.sign(np.diff(targets[:, 0]))
    his = result.effective_width_mm**2 - (4.133 * beside.mean()) ** 2
    width = np.sqrt(his * 20 / 19)
    assert width == pytest.approx(106.062885, rel=1e-3)
    mean_distance = np.mean(result.effective_distances_mm)
    assert mean_distance == pytest.approx(327.058351, rel=1e-3)
    difficulty = np.log2(mean_distance / width + 1)
    assert difficulty == pytest.approx(2.029851, rel=1e-3)
    assert difficulty / np.mean(taps[:, 1]) * 1000.0 == pytest.approx(8.044111, rel=1e-3)
    ours = np.log2(mean_distance / result.effective_width_mm + 1) / difficulty * 8.044111
    assert result.bits_per_s == pytest.approx(ours, rel=0.01)


@pytest.mark.parametrize(
    ("touches", "times", "words"),
    [
        (np.zeros((3, 3)), [0, 1, 2, 3], "at least four touches"),
        (np.eye(4, 3), [0, 1, 1, 2], "times rise"),
        (np.arange(12.0).reshape(4, 3), [0, 1, 2, 3], "not exactly on their targets"),
    ],
)
def test_throughput_without_movements_is_refused(touches, times, words):
    targets = np.arange(12.0).reshape(4, 3)
    with pytest.raises(InputError, match=words):
        effective_throughput(targets, touches, np.array(times, dtype=float))
