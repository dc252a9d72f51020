"""Motion metrics agree with published values, contact and pressing with values by hand."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.signal

from rastrainer.journal.recording import Recording
from rastrainer.motion import trajectory
from rastrainer.motion.trajectory import (
    INTENDED_MM,
    Interval,
    Touch,
    Trajectory,
    pressing_depth,
    unintended_contact,
)
from rastrainer.motion.trial_motion import effective_throughput, trial_motion
from rastrainer.protocol import Proximity
from Testing import journal_lines
from Testing.journal_lines import at, header, proximity, sample

BELL_HZ = 100.0
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
    assert trajectory.sparc(BELL, BELL_HZ) == pytest.approx(-1.41403, abs=5e-6)


def test_log_dimensionless_jerk_matches_its_authors_own_example():
    """Balasubramanian et al. 2015, their program's examples, with and without the logarithm."""
    assert trajectory.log_dimensionless_jerk(BELL, BELL_HZ) == pytest.approx(-5.81636, abs=5e-6)
    assert np.exp(-trajectory.log_dimensionless_jerk(BELL, BELL_HZ)) == pytest.approx(
        335.74684, abs=5e-6
    )


def test_low_pass_agrees_with_scipys_zero_phase_butterworth():
    rng = np.random.default_rng(0)
    t = np.arange(0, 10, 1 / BELL_HZ)
    values = np.column_stack([np.sin(2 * np.pi * t), 50 * t + rng.normal(size=len(t))])
    expected = scipy.signal.sosfiltfilt(
        scipy.signal.butter(2, 6.0, fs=BELL_HZ, output="sos"), values, axis=0
    )
    difference = trajectory.low_pass(values, BELL_HZ, 6.0) - expected
    assert np.abs(difference[50:-50]).max() < 0.05


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


RATE_HZ = 50.0


def straight(touches=(), contacts=(), **more):
    """Return a path of 100 mm along x in 10 s, at constant speed."""
    times = np.arange(0.0, 10.0 + 1e-9, 1 / RATE_HZ)
    tip = np.column_stack([10.0 * times, 0 * times, 0 * times])
    depth = np.zeros(len(times))
    clearance = np.full(len(times), 5.0)
    return Trajectory(
        times, tip, clearance, tuple(touches), contacts=tuple(contacts), depth_mm=depth, **more
    )


def touch(label, x_mm, time_s):
    return Touch(label, (x_mm, 0.0, 0.0), time_s)


BOTH_ENDS = (touch("1", 0.0, 0.0), touch("2", 100.0, 10.0))


def test_dragging_between_touches_counts_except_five_millimeters_at_each_end():
    assert INTENDED_MM == 5.0
    dragged = straight(BOTH_ENDS, [Interval(0.0, 10.0)])
    time_s, way_mm = unintended_contact(dragged)
    assert (time_s, way_mm) == (pytest.approx(9.0), pytest.approx(90.0))
    assert trial_motion(dragged)["unintended_contacts"] == 0.0


def test_contact_is_timed_from_start_to_end_between_samples():
    time_s, way_mm = unintended_contact(straight(BOTH_ENDS, [Interval(2.003, 9.001)]))
    assert (time_s, way_mm) == (pytest.approx(6.998), pytest.approx(69.98))
    time_s, way_mm = unintended_contact(straight(BOTH_ENDS, [Interval(5.001, 5.006)]))
    assert (time_s, way_mm) == (pytest.approx(0.005), pytest.approx(0.05))


def test_contact_near_the_previous_or_next_touch_is_intended():
    at_both = [Interval(0.0, 0.45), Interval(9.6, 10.0)]
    assert unintended_contact(straight(BOTH_ENDS, at_both)) == (0.0, 0.0)


def test_contact_near_any_other_touch_or_without_a_kept_one_is_unintended():
    later = (*BOTH_ENDS, touch("3", 50.0, 10.5))
    time_s, _ = unintended_contact(straight(later, [Interval(4.6, 5.4)]))
    assert time_s == pytest.approx(0.8)
    contacts = [Interval(0.0, 0.4), Interval(9.8, 10.0)]
    time_s, way_mm = unintended_contact(straight((), contacts))
    assert (time_s, way_mm) == (pytest.approx(0.6), pytest.approx(6.0))


def fifteen(depths_mm, further=()):
    """Return fifteen touches in separate contacts, and further contacts."""
    touches = [touch(str(i + 1), 5.0 * i, 0.5 * i + 0.1) for i in range(15)]
    contacts = [
        Interval(0.5 * i, 0.5 * i + 0.2, greatest_depth_mm=depth)
        for i, depth in enumerate(depths_mm)
    ]
    return straight(touches, [*contacts, *further])


@pytest.mark.parametrize(
    ("depths_mm", "expected_mm"),
    [
        pytest.param([2.0] * 15, 2.0, id="every-touch"),
        pytest.param([3.0] + [0.0] * 14, np.sqrt(9 / 15), id="one-touch"),
        pytest.param([1.0, 2.0] + [0.0] * 13, np.sqrt(5 / 15), id="two-touches"),
        pytest.param([0.0] * 15, 0.0, id="gentle"),
    ],
)
def test_pressing_depth_is_the_root_mean_square_over_all_fifteen_fiducials(depths_mm, expected_mm):
    assert pressing_depth(fifteen(depths_mm)) == pytest.approx(expected_mm)


def test_the_pressing_depth_is_averaged_over_the_known_fiducials():
    known = {str(i + 1): np.zeros(3) for i in range(15)}
    pressed = straight(BOTH_ENDS, [Interval(0, 1, greatest_depth_mm=2.0)], fiducials_mm=known)
    assert pressing_depth(pressed) == pytest.approx(np.sqrt(4 / 15))
    assert pressing_depth(replace(pressed, fiducials_mm={})) == pytest.approx(np.sqrt(4 / 2))
    assert pressing_depth(replace(pressed, fiducials_mm={}, touches=())) == pytest.approx(2.0)


def recorded(sample_mm=0.1, touch_mm=0.1):
    """Return the lines of one contact with a touch in it, by the depths of sample and touch."""
    return [
        at(0.01, header(0.01)),
        at(0.02, sample(depth_mm=0.1)),
        at(0.03, proximity(Proximity.PROXIMITY, Proximity.CONTACT)),
        at(0.04, sample(depth_mm=sample_mm)),
        at(0.06, journal_lines.touch("1", depth_mm=touch_mm)),
    ]


END = at(0.08, proximity(Proximity.CONTACT, Proximity.FREE, 2.5))


def test_the_depth_of_a_contact_is_the_maximum_of_samples_touch_and_end():
    for lines, depth in ((recorded(sample_mm=1.5), 1.5), (recorded(touch_mm=1.7), 1.7)):
        (contact,) = Recording.of(lines).trajectory().contacts
        assert contact.greatest_depth_mm == depth
    trajectory = Recording.of([*recorded(), END]).trajectory()
    assert trajectory.contacts[0].greatest_depth_mm == 2.5
    np.testing.assert_array_equal(trajectory.depth_mm, [0.1, 0.1])
    assert pressing_depth(trajectory) == 2.5
