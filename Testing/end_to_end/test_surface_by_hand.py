"""A registration by surface from the menu to the result, by gamepad and by the window's keys alone.

The trainee draws where the ring is. The simulator registers the trace and scores it itself.
"""

from __future__ import annotations

import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer.number_text import with_units
from rastrainer.protocol import MIN_TRACE_POINTS
from rastrainer.trial.scoring import SCORE_VERSION
from Testing.end_to_end.drawing_trainee import COARSE, METHOD, DrawingTrainee
from Testing.end_to_end.hands import GamepadHands, KeyHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.test_gamepad_session import type_by_gamepad
from Testing.simulator.landmarked import write_landmarked

# A window that the processor draws needs the machine to itself, and drawing takes minutes.
pytestmark = pytest.mark.soak

SPEEDS = {"gamepad": "2", "keyboard": "0.4"}
"""Simulated seconds per second: a key is released in time, however late a picture is."""
SMALL = (640, 360)
TRAINEE = "P7"
POINTS = 70


@pytest.fixture(scope="module", params=["gamepad", "keyboard"])
def drawn(tmp_path_factory, request) -> dict:
    """Choose the method, touch landmarks, draw, accept the match; return the results."""
    device = request.param
    folder = tmp_path_factory.mktemp(device)
    options = ["--scenario", str(write_landmarked(folder / "scenario"))]
    options += ["--speed", SPEEDS[device], "--seed", "9"]
    if device == "keyboard":
        options.append("--no-gamepad")
    with Lab(folder, *options, guidance="arrow") as lab:
        if device == "keyboard":
            lab.open_window("window", SMALL)
            hands = KeyHands(lab.keyboard)
        else:
            hands = GamepadHands(lab.simulator)
        trainee = DrawingTrainee(lab.view, hands)
        trainee.read_introduction()
        if device == "keyboard":
            trainee.focus("trainee")
            hands.type(TRAINEE.lower())
            trainee.until(lambda: trainee.value("trainee").upper() == TRAINEE, "the typed ID")
        else:
            type_by_gamepad(trainee, TRAINEE)
        trainee.choose_method(METHOD)
        trainee.begin_task("task-1")
        trainee.touch_landmarks()
        seen = {"rings": trainee.draw_until(POINTS), "match": trainee.accept_match()}
        (path,) = lab.records.glob("*.journal")
        reading = read_journal(path)
    seen["operators"] = {entry["operator"] for entry in reading.of_kind("input")} - {""}
    seen["touched"] = [entry["label"] for entry in reading.of_kind("touch")]
    seen["traced"] = reading.of_kind("trace")
    (registered,), (scored,) = reading.of_kind("registration"), reading.of_kind("scored")
    seen["registered"], seen["scored"] = registered["arguments"], scored["arguments"]
    return seen | {"device": device, "result": trainee.menu}


def test_landmarks_and_trace_are_recorded_with_that_device_alone(drawn):
    assert drawn["operators"] == {drawn["device"]}
    assert drawn["touched"] == [landmark.name for landmark in COARSE]
    assert len(drawn["traced"]) >= POINTS > MIN_TRACE_POINTS


def test_the_match_shown_to_the_trainee_is_the_one_that_is_registered(drawn):
    shown, registered = drawn["match"], drawn["registered"]
    assert shown["Residual"] == with_units(f"{registered['freMm']:.2f} mm")
    expected = with_units(f"{registered['expectedTreMm']:.2f} mm")
    assert shown["Expected error at the target (TRE)"] == expected
    assert registered["freMm"] < 1.0


def test_the_trial_is_scored_and_the_true_error_revealed(drawn):
    assert drawn["scored"]["details"]["scoreVersion"] == SCORE_VERSION
    shown = {fact.label: fact.value for fact in drawn["result"].facts}
    assert float(shown["True error at the target (TRE)"].removesuffix("mm")) < 5.0
