"""Everything that happens is heard and felt once."""

from __future__ import annotations

from collections import Counter

import numpy as np
import pytest

from rastrainer.journal.entries import ProximityChange
from rastrainer.protocol import Proximity
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.presentation.feedback_event import (
    FeedbackEvent,
    feedback_event,
    touch_feedback,
)
from rastrainer_simulator.state import TOUCH_ERRORS, Event, TouchStage
from Testing.simulator.flow.test_whole_flow import REGISTRATION, SCORE


@pytest.fixture(scope="module")
def shared(simulation):
    return simulation


def feedback_events_of(loop):
    """Return a list that fills with what the loop's events mean."""
    heard = []

    before = [TouchStage.FAR]

    def hear(result):
        touch = result.state.touch
        felt = [feedback_event(event, touch) for event in result.events]
        heard.extend(filter(None, felt or [touch_feedback(before[0], touch)]))
        before[0] = touch

    loop.subscribe(hear)
    return heard


def test_touch_undo_proximity_contact_and_finish_give_sound_and_vibration_exactly_once(pilot, felt):
    expected = feedback_events_of(pilot.loop)
    # SDL only prolongs what vibrates already: here simulated time is faster than the motors.
    pilot.presenter.updates.add(lambda _news: pilot.presenter.rumble(0.0, 0.0))
    pilot.start("task-1")
    center, top = pilot.place(), pilot.place("1")
    outward = (top - center) / np.linalg.norm(top - center)
    pilot.steer_to(top + 0.06 * outward, 0.02)
    pilot.steer_to(top - 0.02 * outward, 0.001, fine=True)
    pilot.steer_to(top + 0.06 * outward, 0.02)
    pilot.hands.push(0.0, 0.0, 0.0, False)
    pilot.touch_anywhere()
    pilot.tap("undo")
    pilot.until(lambda: len(pilot.state.training.touches) == 14)
    pilot.step(2)
    pilot.tap("touch")
    pilot.until(lambda: pilot.state.training.phase == "complete")
    pilot.step(2)
    pilot.tap_until("touch", "complete")
    pilot.tap_until("accept", "waiting")
    trial_id = pilot.state.training.trial_id
    assert pilot.submit("SubmitRegistration", trialId=trial_id, **REGISTRATION).ok
    assert pilot.submit("TrialScored", trialId=trial_id, **SCORE).ok
    pilot.until(lambda: pilot.state.training.phase == "scored")
    found = [kind for kind in pilot.watcher.kinds if kind not in ("focus", "accept")]
    assert found == [each.value for each in expected]
    counted = Counter(found)
    assert counted["touch"] == 16
    assert counted["undo"] == counted["finish"] == 1
    assert counted["proximity-in"] == counted["proximity-out"] >= 1
    assert counted["on-skin"] >= counted["contact-out"] >= 1
    assert counted["contact"] >= 1
    strengths = [each.rumble for each in expected]
    assert [low for low, _ in felt if low > 0.0] == pytest.approx(strengths, abs=1e-4)
    numbers = [feedback.number for feedback in pilot.watcher.feedbacks]
    assert numbers == list(range(1, len(numbers) + 1))


def test_every_named_sound_ships_with_rastrainer():
    sounds = {each.sound for each in FeedbackEvent} - {""}
    assert sounds == {path.stem for path in asset_path("sounds").glob("*.wav")}


def test_the_alarm_sounds_once_when_a_touch_goes_wrong_and_when_the_arm_touches():
    for error in TOUCH_ERRORS:
        assert touch_feedback(TouchStage.ON_SKIN, error) is FeedbackEvent.CONTACT
        assert touch_feedback(error, error) is None
    assert touch_feedback(TouchStage.TOO_DEEP, TouchStage.ON_SKIN) is FeedbackEvent.ON_SKIN
    for before, after, meant in (
        (Proximity.FREE, Proximity.CONTACT, FeedbackEvent.CONTACT),
        (Proximity.FREE, Proximity.PROXIMITY, FeedbackEvent.PROXIMITY_IN),
        (Proximity.CONTACT, Proximity.FREE, FeedbackEvent.PROXIMITY_OUT),
    ):
        entry = ProximityChange(from_=before, to=after, clearance_mm=0.0)
        assert feedback_event(Event(0.0, entry), TouchStage.ELSEWHERE) is meant
