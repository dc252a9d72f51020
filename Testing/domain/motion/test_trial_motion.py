"""Motion metrics of a whole trial, compared with values computed by hand."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.journal.entries import CameraChange, Undo
from rastrainer.journal.recording import Recording
from rastrainer.motion.trajectory import Interval, Touch, Trajectory
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.protocol import Phase, Proximity
from rastrainer.study.outcomes import MOTION_METRICS
from Testing.journal_lines import at, header, phase, proximity, sample, touch


def reaches(corners_mm, duration_s=2.0, rest_s=1.0, rate_hz=50.0):
    """Minimum-jerk reaches between corners with rests, touched in the middle of each rest."""
    t = np.arange(0, duration_s, 1 / rate_hz) / duration_s
    shape = 10 * t**3 - 15 * t**4 + 6 * t**5
    rest = int(rest_s * rate_hz)
    path = [np.repeat([corners_mm[0]], rest, axis=0)]
    for start, end in itertools.pairwise(corners_mm):
        path += [start + shape[:, None] * (end - start), np.repeat([end], rest, axis=0)]
    tip = np.concatenate(path)
    times = np.arange(len(tip)) / rate_hz
    touch_times = rest_s / 2 + (duration_s + rest_s) * np.arange(len(corners_mm))
    touches = tuple(
        Touch(str(i + 1), tuple(corner), float(time))
        for i, (corner, time) in enumerate(zip(corners_mm, touch_times, strict=True))
    )
    return times, tip, touches


CORNERS = np.array([[0, 0, 0], [100, 0, 0], [100, 80, 0], [20, 80, 0], [20, 80, 90]], dtype=float)


@pytest.fixture
def trajectory():
    times, tip, touches = reaches(CORNERS)
    return Trajectory(times, tip, np.full(len(times), 30.0), touches)


def test_path_speed_and_rest_of_minimum_jerk_reaches(trajectory):
    motion = trial_motion(trajectory)
    assert motion["path_length_mm"] == pytest.approx(350.0, rel=2e-3)
    assert motion["path_between_touches_mm"] == pytest.approx(350.0, rel=2e-3)
    # A minimum-jerk reach has its peak speed, 1.875 times the mean, in the middle.
    assert motion["peak_speed_mm_s"] == pytest.approx(1.875 * 100 / 2, rel=0.01)
    assert motion["movement_time_s"] == pytest.approx(3.0)
    assert motion["completion_time_s"] == pytest.approx(12.5)
    assert motion["dwell_before_touch_s"] == pytest.approx(0.5 + 0.2, abs=0.15)
    assert motion["idle_time_s"] == pytest.approx(5.0, abs=0.6)
    assert motion["sparc"] == pytest.approx(-1.5, abs=0.2)


def whole(trajectory, **more):
    """A complete trial of a known task."""
    known = {str(i + 1): point + 0.1 * i**2 for i, point in enumerate(CORNERS)}
    return replace(trajectory, fiducials_mm=known, shortest_path_mm=350.0, **more)


def test_contacts_are_separated_into_intended_and_unintended(trajectory):
    contacts = (Interval(0.3, 0.9, -0.02), Interval(2.0, 2.2, -0.4))
    motion = trial_motion(replace(trajectory, near=(Interval(0.0, 2.5),), contacts=contacts))
    assert (motion["contacts"], motion["unintended_contacts"]) == (2, 1)
    assert motion["contact_time_s"] == pytest.approx(0.8)
    assert motion["deepest_contact_mm"] == pytest.approx(0.4)
    assert motion["proximity_time_s"] == pytest.approx(2.5)


def test_throughput_and_wrong_touches_need_known_fiducials(trajectory):
    assert "throughput_bit_s" not in trial_motion(trajectory)
    offsets = np.array([[0, 0, 0], [1, 0, 0], [0, -1, 0], [-2, 0, 0], [0, 0, 1]])
    known = {str(i + 1): point for i, point in enumerate(CORNERS + offsets)}
    refused = (
        Touch("2", (100.0, 79.0, 0.0), 4.0),
        Touch("2", (50.0, 0.0, 0.0), 4.1),
        Touch("2", (89.0, 0.0, 0.0), 4.2),
    )
    motion = trial_motion(replace(trajectory, refused=refused, fiducials_mm=known))
    assert motion["throughput_bit_s"] > 1.0
    assert (motion["refused_touches"], motion["wrong_order_touches"]) == (3, 1)


def test_every_metric_has_a_definition_and_every_definition_a_metric(trajectory):
    motion = trial_motion(whole(trajectory, depth_mm=np.zeros(len(trajectory.times_s))))
    assert set(motion) == set(MOTION_METRICS)
    assert all(np.isfinite(value) for value in motion.values())


def test_a_recording_excludes_pauses_and_undone_touches():
    lines = [
        at(10.004, header()),
        at(10.02, sample()),
        at(10.104, touch("1")),
        at(10.204, phase(Phase.PAUSED, "2")),
        at(15.204, phase(Phase.RUNNING, "2")),
        at(15.3, proximity(Proximity.FREE, Proximity.PROXIMITY)),
        at(15.4, sample((1.0, 0.0, 0.0))),
        at(15.504, touch("2", kept=2)),
        at(15.604, Undo("2", kept=1, next_point="2")),
        at(15.704, touch("2", (4.0, 5.0, 6.0), kept=2)),
        at(15.8, CameraChange("far")),
    ]
    trajectory = Recording.of(lines).trajectory()
    np.testing.assert_allclose(trajectory.times_s, [0.02, 0.4])
    np.testing.assert_allclose(trajectory.touch_times_s, [0.1, 0.7])
    assert trajectory.touches[1].position_mm == (4, 5, 6)
    assert (trajectory.undone, trajectory.pauses, trajectory.camera_switches) == (1, 1, 1)
    assert trial_motion(trajectory)["pause_time_s"] == pytest.approx(5.0)
    assert trajectory.near[0].start_s == pytest.approx(0.3)


def test_waiting_for_the_result_after_the_last_touch_is_not_idle_time(trajectory):
    waiting = np.arange(1, 60 * 50) / 50.0
    waited = replace(
        trajectory,
        times_s=np.concatenate([trajectory.times_s, trajectory.times_s[-1] + waiting]),
        tip_mm=np.concatenate([trajectory.tip_mm, np.repeat([CORNERS[-1]], len(waiting), axis=0)]),
        clearance_mm=np.full(len(trajectory.times_s) + len(waiting), 30.0),
    )
    idle_s = trial_motion(trajectory)["idle_time_s"]
    assert trial_motion(waited)["idle_time_s"] == pytest.approx(idle_s)
    assert idle_s < trial_motion(waited)["completion_time_s"]


def test_touches_that_could_not_be_written_do_not_count():
    lines = [
        at(0.004, header()),
        at(1.0, touch("1")),
        at(2.0, touch("2", kept=2)),
        at(2.1, phase(Phase.PAUSED, "2")),
    ]
    assert [touch.label for touch in Recording.of(lines).trajectory().touches] == ["1"]
