"""The page of the result: its sentences about a score, and about a trial beyond a limit."""

from __future__ import annotations

import pytest

from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.screen import Tone
from Testing.simulator.flow.conftest import Outside
from Testing.simulator.flow.test_whole_flow import REGISTRATION
from Testing.simulator.flow.trainee import RATE_HZ, Keys, Trainee


@pytest.fixture(scope="module")
def registered(simulation, tmp_path_factory):
    """Return a trainee who waits for the score of a trial that was played."""
    folder = tmp_path_factory.mktemp("played")
    with ControlLoop(simulation, folder / "records", rate_hz=RATE_HZ, speed=None) as loop:
        presenter = Outside(folder).presenter(loop, view="never")
        trainee = Trainee(loop, presenter, Keys)
        trainee.records = folder / "records"
        trainee.until_menu("start")
        trainee.start("task-1")
        trainee.touch_anywhere()
        trial = trainee.register()
        assert trainee.submit("SubmitRegistration", trialId=trial, **REGISTRATION).ok
        yield trainee
        trainee.close()
        presenter.close()


@pytest.fixture
def result_of(registered):
    """Have the trial scored, again, with these details, and return the menu of the result."""

    def show(score=95.0, **details):
        trial = registered.state.training.trial_id
        assert registered.submit("TrialScored", trialId=trial, score=score, details=details).ok
        result = lambda: registered.state.training.result  # noqa: E731
        registered.until(lambda: result() is not None and result().details == details, "the score")
        registered.until_menu("result")
        registered.step(50)
        return registered.menu

    return show


WITHIN = {"regionTreMm": 0.73, "isAccurate": True, "isUnbiased": True, "isSafe": True}
RESIDUALS_MM = [0.4] * 6 + [4.1] + [0.4] * 8


def test_each_value_of_a_passed_trial_stands_beside_its_limit(result_of):
    measured = {"commonBiasMm": 0.41, "contactTimeS": 1.25, "pressingDepthMm": 0.3}
    limits = {"regionLimitMm": 0.8, "passMark": 70.0}
    menu = result_of(**WITHIN, **measured, **limits, contactPathMm=12.0, residualsMm=RESIDUALS_MM)
    assert menu.title == "P07, Task 1: passed"
    assert [(fact.label, fact.value, fact.tone) for fact in menu.facts[:5]] == [
        ("Score", "95 / 100 (pass mark 70)", Tone.GOOD),
        ("True error in the brain (TRE)", "0.73 mm (max. 0.8)", Tone.GOOD),
        ("Bias that all touches share", "0.41 mm (max. 1.5)", Tone.GOOD),
        ("Unintended contact", "1.2 s (max. 8)", Tone.GOOD),
        ("Pressed into the head", "0.30 mm (max. 1.5)", Tone.GOOD),
    ]
    names = [item.name for item in menu.items]
    assert names == ["next", "errors", "worst", "replay", "again", "menu"]
    assert menu.focus == "next"
    without_mark = result_of(passMark=None)
    assert (without_mark.title, without_mark.facts[0].tone) == ("P07: Task 1", Tone.PLAIN)


BEYOND = {
    "inaccurate": (
        {"isAccurate": False, "regionTreMm": 1.6},
        "An instrument guided by this registration could miss its target.",
    ),
    "biased": (
        {"isUnbiased": False, "commonBiasMm": 1.81},
        "All touches are off in the same direction, which the registration error cannot show.",
    ),
    "unsafe": (
        {"isSafe": False, "contactPathMm": 170.0},
        "The tool rested on the head too long, or was pressed in too deeply.",
    ),
    "below the mark": ({"passMark": 96.0}, "Within all limits, but below the pass mark."),
    "procedure": ({"procedure": {"score": 31.0, "acceptable": False}}, None),
}


@pytest.mark.parametrize("name", BEYOND)
def test_a_failure_says_why_and_leads_to_what_helps(result_of, name):
    details, reason = BEYOND[name]
    placed = {"procedure": {"score": 59.0, "acceptable": True}}
    menu = result_of(**{**WITHIN, "passMark": 10.0, **placed, **details}, residualsMm=RESIDUALS_MM)
    assert menu.title == "P07, Task 1: not passed"
    assert reason is None or menu.paragraphs[0] == reason
    assert Tone.GOOD not in [fact.tone for fact in menu.facts]
    names = [item.name for item in menu.items]
    assert names[:3] == ["worst", "practice", "again"]
    assert names.index("next") > names.index("replay")
    assert menu.focus == "worst"
    assert menu.items[1].label == "Practice point 7"


def test_the_worst_point_is_practiced_again_and_nothing_is_recorded(registered, result_of):
    result_of(**{**WITHIN, "isAccurate": False}, residualsMm=RESIDUALS_MM)
    trial, records = registered.state.training.trial_id, registered.records
    before = sorted(path.name for path in records.iterdir())
    registered.choose("practice", None)
    shown = lambda: registered.presenter.shown.latest.training  # noqa: E731
    assert shown().next_point == "7"
    screen = registered.presenter.screen
    assert screen.status[0] == "Task 1: practice of point 7"
    registered.until(lambda: not registered.presenter._flow._tutorial_screen._is_moving, "the arm")
    registered.touch_point("7")
    registered.until_menu("practiced")
    assert registered.menu.facts[0].label == "Error of your touch"
    assert registered.state.training.trial_id == trial
    assert sorted(path.name for path in records.iterdir()) == before
    registered.step(50)
    registered.choose("again", None)
    assert shown().touches == ()
    registered.tap_until("menu", "tutorial")
    registered.choose("leave", "experiment")
