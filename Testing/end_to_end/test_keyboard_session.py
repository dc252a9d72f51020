"""From the start menu to the result by the window's keyboard alone; the window crashes within."""

from __future__ import annotations

import pytest

from Testing.end_to_end.hands import KeyHands
from Testing.end_to_end.lab import Lab, trial_of
from Testing.end_to_end.stream_trainee import StreamTrainee
from Testing.end_to_end.window_process import wait_until

SPEED = "3"
SMALL = ("--size", "640x360", "--quality", "low")
TRAINEE = "p07"
KILLED_AFTER = 5


@pytest.fixture(scope="module")
def session(tmp_path_factory) -> dict:
    """Play the whole flow; return what came of it."""
    folder = tmp_path_factory.mktemp("keyboard")
    with Lab(folder, "--speed", SPEED, "--seed", "8", "--no-gamepad") as lab:
        slicer = lab.start_slicer()
        window = lab.open_window("window", *SMALL)
        trainee = StreamTrainee(lab.view, KeyHands(lab.keyboard))
        to_task(trainee)
        for number in range(1, KILLED_AFTER + 1):
            touch(trainee, str(number))
        crash = kill_while_moving(lab, trainee, window)
        lab.open_window("another", *SMALL)
        for number in range(KILLED_AFTER + 1, 16):
            touch(trainee, str(number))
        trainee.press("touch", lambda: trainee.menu is not None, "the end of the task")
        trainee.until_menu("complete")
        trainee.choose("register")
        results = trial_of(slicer)
        trainee.until_menu("result")
        return {"results": results, "menu": trainee.menu, "crash": crash, "view": lab.view}


def to_task(trainee: StreamTrainee) -> None:
    trainee.until_menu("start")
    trainee.choose("train")
    trainee.until_menu("introduction")
    trainee.press("accept", lambda: trainee.menu.name == "controls", "the controls")
    trainee.choose("next")
    trainee.until_menu("experiment")
    trainee.focus("trainee")
    trainee.hands.type(TRAINEE)
    trainee.until(lambda: trainee.value("trainee").lower() == TRAINEE, "the typed ID")
    trainee.choose("trial-run")
    trainee.until_menu(None)
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    trainee.choose("finish")
    trainee.until_menu("experiment")
    trainee.choose("task-1")
    trainee.until_menu(None)


def touch(trainee: StreamTrainee, label: str) -> None:
    trainee.approach(label, 0.03)
    trainee.press_on(label)


def kill_while_moving(lab: Lab, trainee: StreamTrainee, window) -> dict:
    """Kill the window while a key is held; return what became of the arm and the trial."""
    lab.keyboard.hold("KeyR", True)
    start = trainee.tip.copy()
    trainee.until(lambda: abs(trainee.tip - start).max() > 0.01, "a move of the arm")
    window.kill()
    lab.keyboard.hold("KeyR", False)
    places = []

    def stands() -> bool:
        places.append(trainee.tip.tolist())
        return len(places) > 20 and places[-1] == places[-20]

    wait_until(stands, "the arm's stop")
    state = lab.view.state
    return {"phase": state["phase"], "touched": len(state["touched"]), "time": state["elapsed"]}


def test_slicer_scores_the_trial_of_that_trainee(session):
    results = session["results"]["results"]
    assert results["trainee"].lower() == TRAINEE
    assert session["menu"].name == "result"


def test_killing_the_window_stops_the_arm_and_loses_nothing(session):
    crash = session["crash"]
    assert crash["touched"] == KILLED_AFTER
    assert crash["phase"] in ("running", "paused")
