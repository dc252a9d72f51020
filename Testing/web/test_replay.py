"""A trial replayed on the page, controlled by its keyboard."""

from __future__ import annotations

import pytest

from rastrainer.igtl.client import Client
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.virtual.scripted_trial import play_trial, send_hello
from Testing.end_to_end.registered_trial import registration_of
from Testing.web.chromium import open_page, wait_for
from Testing.web.hands import PageKeys
from Testing.web.place import WITHOUT_GRAPHICS, Place

# A trial is played first: minutes.
pytestmark = pytest.mark.soak

SCORE = {"score": 81.0}
POINTS = 15


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A place at which a trial has been played and scored."""
    folder = tmp_path_factory.mktemp("replay")
    scenario = load_scenario(asset_path("scenarios", "colin27"))
    with Place(folder, "--speed", "4", limits=WITHOUT_GRAPHICS) as place:
        with Client(port=place.simulator.port) as slicer:
            send_hello(slicer, "Slicer")
            trial = play_trial(slicer, scenario, "task-1", "P07", 5)
            found = registration_of(slicer, trial.trial_id, scenario)
            scored = {"trialId": trial.trial_id, **SCORE}
            assert slicer.send_command("SubmitRegistration", found, timeout=60).ok
            assert slicer.send_command("TrialScored", scored, timeout=60).ok
        yield place


def test_a_trial_is_replayed_sought_and_closed_by_keyboard(place, browser):
    page = open_page(browser, place.simulator.url, place.simulator.code)
    trainee = place.trainee(PageKeys(page))
    trainee.until_menu("result")
    trainee.choose("replay")
    trainee.until_menu(None)
    wait_for(page, "page.screen.instruction.text === 'Replay: Task 1 of P07'")
    trainee.until(lambda: trainee.view.state["phase"] == "running", "the replay")
    for _ in range(3):
        trainee.hands.tap("right")
    trainee.until(lambda: 0 < trainee.touched < POINTS, "a later part of the replay")
    trainee.hands.tap("up")
    trainee.until(lambda: "worst" in trainee.view.screen.instruction.text, "the worst touch")
    trainee.hands.tap("back")
    trainee.until_menu("result")
    trainee.until(lambda: trainee.view.state["phase"] == "scored", "the arm")
    assert page.problems == []
    page.close()
