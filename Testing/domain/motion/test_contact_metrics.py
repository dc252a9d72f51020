"""Unintended contact and pressing depth, compared with values computed by hand."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer.journal.recording import Recording
from rastrainer.motion.trajectory import (
    INTENDED_MM,
    Interval,
    Touch,
    Trajectory,
    pressing_depth,
    unintended_contact,
)
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.protocol import Proximity
from Testing import journal_lines
from Testing.journal_lines import at, header, proximity, sample

RATE_HZ = 50.0
SEEDS = range(4)


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


def test_contact_near_any_other_touch_is_unintended():
    later = (*BOTH_ENDS, touch("3", 50.0, 10.5))
    time_s, _ = unintended_contact(straight(later, [Interval(4.6, 5.4)]))
    assert time_s == pytest.approx(0.8)


def test_without_a_kept_touch_all_contact_is_unintended():
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


def test_an_unknown_depth_is_omitted_and_not_zero():
    unknown = replace(fifteen([0.0] * 15), depth_mm=None)
    assert pressing_depth(unknown) is None
    assert "pressing_depth_mm" not in trial_motion(unknown)
    assert trial_motion(fifteen([0.0] * 15))["pressing_depth_mm"] == 0.0


def drawn(seed, has_touches=True):
    """Return a random movement with random touches and five contacts."""
    random = np.random.default_rng(seed)
    times = np.arange(501) / RATE_HZ
    tip = np.cumsum(random.normal(0.0, 1.0, (501, 3)), axis=0)
    rows = np.sort(random.choice(np.arange(10, 490), 15, replace=False)) if has_touches else ()
    touches = tuple(Touch(str(row), tuple(tip[row]), float(times[row])) for row in rows)
    contacts = tuple(
        Interval(
            2.0 * i + random.uniform(0.0, 0.9),
            2.0 * i + random.uniform(1.0, 1.9),
            greatest_depth_mm=float(random.uniform(0.0, 3.0)),
        )
        for i in range(5)
    )
    zero = np.zeros(501)
    return Trajectory(times, tip, zero + 1.0, touches, contacts=contacts, depth_mm=zero), random


def measures(trajectory):
    return np.array([*unintended_contact(trajectory), pressing_depth(trajectory)])


@pytest.mark.parametrize("seed", SEEDS)
def test_more_contact_never_lowers_a_measure(seed):
    trajectory, random = drawn(seed)
    i = random.integers(5)
    contacts = list(trajectory.contacts)
    longer = replace(contacts[i], end_s=2.0 * i + 1.95)
    brief = Interval(2.0 * i + 1.96, 2.0 * i + 1.99, greatest_depth_mm=random.uniform(0.0, 3.0))
    before = measures(trajectory)
    contacts[i] = longer
    for more in (contacts, [*contacts[: i + 1], brief, *contacts[i + 1 :]]):
        after = measures(replace(trajectory, contacts=tuple(more)))
        assert (after >= before - 1e-9).all()


@pytest.mark.parametrize("seed", SEEDS)
def test_pressing_deeper_never_lowers_a_measure(seed):
    trajectory, random = drawn(seed)
    i = random.integers(5)
    contacts = list(trajectory.contacts)
    deeper = contacts[i].greatest_depth_mm + random.uniform(0.1, 3.0)
    contacts[i] = replace(contacts[i], greatest_depth_mm=deeper)
    before, after = measures(trajectory), measures(replace(trajectory, contacts=tuple(contacts)))
    assert (after >= before - 1e-9).all()
    assert after[2] > before[2]


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
