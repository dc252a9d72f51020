"""A session by the keyboard alone, from the start menu to the result; the window crashes once."""

from __future__ import annotations

import pytest

from rastrainer.journal.journal_file import read_journal
from Testing.end_to_end.hands import KeyHands
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.stream_trainee import StreamTrainee

# A window that the processor draws needs the machine to itself.
pytestmark = pytest.mark.soak

SPEED = "0.4"
"""Simulated seconds per second: a key is released in time, however late a picture is."""
SMALL = (640, 360)
TRAINEE = "p07"
KILLED_AFTER = 5


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> dict:
    """Play the whole flow; return the results."""
    folder = tmp_path_factory.mktemp("keyboard")
    with Lab(folder, "--speed", SPEED, "--seed", "8", "--no-gamepad") as lab:
        slicer = lab.start_slicer()
        window = lab.open_window("window", SMALL)
        trainee = StreamTrainee(lab.view, KeyHands(lab.keyboard))
        to_task(trainee)
        for number in range(1, KILLED_AFTER + 1):
            trainee.touch(str(number))
        crash = kill_while_moving(lab, trainee, window)
        lab.open_window("another", SMALL)
        for number in range(KILLED_AFTER + 1, 16):
            trainee.touch(str(number))
        trainee.press("touch", lambda: trainee.menu is not None, "the end of the task")
        trainee.until_menu("complete")
        trainee.choose("register")
        results = slicer.events_until("trial")[-1]["results"]
        trainee.until_menu("result")
        return {
            "results": results,
            "menu": trainee.menu,
            "crash": crash,
            "touches": touches_of(lab),
        }


def to_task(trainee: StreamTrainee) -> None:
    trainee.read_introduction()
    trainee.focus("trainee")
    trainee.hands.type(TRAINEE)
    trainee.until(lambda: trainee.value("trainee").lower() == TRAINEE, "the typed ID")
    trainee.choose("trial-run")
    trainee.until_menu(None)
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    trainee.choose("finish")
    trainee.until_menu("experiment")
    trainee.begin_task("task-1")


def kill_while_moving(lab: Lab, trainee: StreamTrainee, window) -> dict:
    """Kill the window while a key is held; return what happened to the arm and the trial."""
    lab.keyboard.hold("KeyR", True)
    trainee.until_moved()
    window.kill()
    lab.keyboard.hold("KeyR", False)
    trainee.until_still()
    trainee.until_menu("trial")
    state = lab.view.state
    return {"phase": state["phase"], "touches": touches_of(lab)}


def touches_of(lab: Lab) -> list[dict]:
    """Return the touches in the journal of the only trial of Task 1."""
    records = [read_journal(path) for path in lab.records.glob("*.journal")]
    (journal,) = [record for record in records if record.header.task == "task-1"]
    return list(journal.of_kind("touch"))


def test_slicer_scores_the_trial_of_that_trainee(session):
    results = session["results"]
    assert results["record"]["trainee"].lower() == TRAINEE
    assert session["menu"].name == "result"


def test_killing_the_window_stops_the_arm_and_pauses_the_trial(session):
    # The arm's stop is waited for.
    assert session["crash"]["phase"] == "paused"


def test_a_new_window_rejoins_the_same_trial_and_nothing_is_lost(session):
    before, after = session["crash"]["touches"], session["touches"]
    assert len(before) == KILLED_AFTER
    assert after[:KILLED_AFTER] == before
    assert [touch["label"] for touch in after] == [str(number) for number in range(1, 16)]
