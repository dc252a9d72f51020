"""The trainee's view: what moves it, what the sticks mean in it, and what the record says."""

import numpy as np
import pytest

from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer_simulator.presentation.messages import Hello
from rastrainer_simulator.record.trial_archive import SUFFIX
from rastrainer_simulator.replay.resimulation import replay
from rastrainer_simulator.state import OperatorInput
from rastrainer_simulator.viewpoint.arm_cover import ArmCover, places_to_see
from rastrainer_simulator.viewpoint.trial_view import turned
from rastrainer_simulator.viewpoint.view_control import FRONT


@pytest.fixture
def by_hand(trainee):
    """Return a trainee whose view does not move by itself."""
    preferences = trainee.presenter._session.preferences
    trainee.presenter._session.preferences = preferences.__class__(view="never")
    return trainee


def orbit(trainee):
    return trainee.presenter._session.view.control.orbit


def wait_for_views(trainee):
    """Wait until the trial's best views are found."""
    is_found = lambda: trainee.presenter.pictures(trainee.state).inset is not None  # noqa: E731
    trainee.until(is_found, "the best view")


def whole_journal(trainee, outside):
    """Return the reading of the aborted trial's journal, once its last line is on the disk."""
    (path,) = outside.services.records.glob(f"*{SUFFIX}")
    trainee.until(lambda: read_journal(path).integrity is Integrity.INTACT, "the journal's end")
    return read_journal(path)


def moved(trainee, steps=40):
    """Return by how much the tip moves in the main picture, (3,): right, up, toward the eye."""
    view = trainee.presenter.pictures(trainee.state).main
    before = np.array(trainee.tip)
    trainee.step(steps)
    ahead = np.subtract(view.focal_point, view.position)
    right = np.cross(ahead, view.view_up)
    frame = np.array([right, np.cross(right, ahead), -ahead])
    frame /= np.linalg.norm(frame, axis=1)[:, None]
    return frame @ (trainee.tip - before)


def test_stick_left_is_left_in_the_picture_however_the_view_is_turned(by_hand):
    by_hand.start("task-1")
    by_hand.presenter.on_orbit(1, -120.0, 0.0, 1.0)
    by_hand.step()
    by_hand.hands.push(-0.7, 0.0, 0.0, False)
    right, up, _near = moved(by_hand)
    assert right < -0.01
    assert abs(up) < 0.1 * abs(right)


def test_the_view_turns_the_sticks_within_full_deflection_and_the_scenario_cameras_not_a_bit():
    sticks = OperatorInput((0.1, -0.7, 0.3), (0.2, 0.9), True, operator="gamepad")
    assert turned(sticks, 0.0) is sticks
    assert turned(sticks, 90.0).translation == pytest.approx((0.7, 0.1, 0.3))
    corner = turned(OperatorInput((1.0, 1.0, 1.0), (1.0, -1.0)), 45.0)
    assert np.linalg.norm(corner.translation) == pytest.approx(1.0)


def test_the_sticks_of_a_headset_follow_the_eyes(by_hand):
    presenter = by_hand.presenter
    presenter.view_left(1)
    presenter.view_joined(5, Hello("headset", "Quest 3", 90.0))
    by_hand.start("task-1")
    for yaw_deg, ahead in ((90.0, (0, 1, 0)), (0.0, (1, 0, 0)), (-90.0, (0, -1, 0))):
        presenter.on_sticks(5, (0.0, 0.8, 0.0), (0.0, 0.0), False, yaw_deg)
        before = np.array(by_hand.tip)
        by_hand.step(25)
        moved = by_hand.tip - before
        assert moved @ ahead > 0.9 * np.linalg.norm(moved) > 0.0


def test_the_view_moves_to_each_next_point_by_itself_and_waits_for_the_sticks(trainee):
    trainee.start("task-1")
    trainee.hands.push(0.0, 0.0, 0.4, True)
    wait_for_views(trainee)
    trainee.step(25)
    assert orbit(trainee) == FRONT
    trainee.hands.push(0.0, 0.0, 0.0, False)
    trainee.until(lambda: orbit(trainee) != FRONT, "the move to the best view")
    trainee.step(200)
    pictures = trainee.presenter.pictures(trainee.state)
    assert pictures.main.focal_point == pytest.approx(pictures.inset.focal_point)


def test_the_best_view_is_shown_on_request_where_it_is_not_automatic(by_hand):
    by_hand.start("task-1")
    wait_for_views(by_hand)
    by_hand.step(50)
    assert orbit(by_hand) == FRONT
    by_hand.tap("best_view")
    by_hand.step(200)
    pictures = by_hand.presenter.pictures(by_hand.state)
    assert pictures.main.focal_point == pytest.approx(pictures.inset.focal_point)
    by_hand.tap("camera")
    by_hand.step(200)
    assert orbit(by_hand) == FRONT


def test_the_best_view_shows_the_point_past_the_arm_as_it_stands(by_hand, setup):
    by_hand.start("task-1")
    wait_for_views(by_hand)
    by_hand.tap("best_view")
    by_hand.step(200)
    view = by_hand.presenter.pictures(by_hand.state).main
    point = np.array(view.focal_point)
    ahead = point - view.position
    ahead /= np.linalg.norm(ahead)
    # The tool comes from the eye, and with it the wrist.
    direction = ahead - (0.0, 0.0, 0.3)
    target = {"positionMm": 1000.0 * (point - 0.03 * direction), "direction": direction}
    answer = by_hand.submit("MoveTipTo", **{name: list(each) for name, each in target.items()})
    assert answer.ok

    def covering():
        eyes = {"view": by_hand.presenter.pictures(by_hand.state).main.position}
        return ArmCover(setup).covering(
            by_hand.state, eyes, places_to_see(by_hand.state, setup.scenario)
        )

    by_hand.until(lambda: covering()["view"], "the arm before the point")
    by_hand.step(200)
    assert covering()["view"]
    by_hand.tap("best_view")
    by_hand.step(200)
    assert covering() == {"view": ()}
    assert by_hand.presenter.pictures(by_hand.state).main.focal_point == pytest.approx(point)


def test_a_trial_with_a_turning_view_replays_bit_for_bit(by_hand, outside):
    by_hand.start("task-1")
    for around in (25.0, -80.0, 160.0):
        by_hand.presenter.on_orbit(1, around, 3.0, 0.9)
        by_hand.hands.push(0.4, -0.7, 0.2, False)
        by_hand.presenter.on_key(1, "KeyE", True, "")
        by_hand.step(30)
        by_hand.presenter.on_key(1, "KeyE", False, "")
    by_hand.hands.push(0.0, 0.0, 0.0, False)
    turned_to = orbit(by_hand)
    by_hand.step(20)
    by_hand.submit("Abort")
    journal = whole_journal(by_hand, outside)
    report = replay(journal, by_hand.loop.setup)
    assert report.difference is None
    assert report.compared["input"] > 50
    last = journal.of_kind("view")[-1]
    assert last["azimuthDeg"] == pytest.approx(turned_to.azimuth_deg, abs=0.1)
    assert last["zoom"] == pytest.approx(turned_to.zoom, abs=0.01)
    assert not last["follows"]
