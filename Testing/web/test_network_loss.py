"""A network that stalls or breaks during training: paused, resumed, nothing lost."""

from __future__ import annotations

import numpy as np
import pytest

from Testing.web.chromium import enter_headset, open_page, wait_for
from Testing.web.hands import Controllers, PageKeys
from Testing.web.place import WITHOUT_GRAPHICS, Place
from Testing.web.relay import Relay

LOST = "#warnings li[data-tone=error]:has-text('connection to the simulator was lost')"
TOUCHED = 2


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("network"), limits=WITHOUT_GRAPHICS) as place:
        yield place


@pytest.fixture
def relay(place):
    with Relay(int(place.simulator.url.rpartition(":")[2])) as relay:
        yield relay


def begin(place, relay, browser, headset):
    page = open_page(browser, relay.url, place.simulator.code, headset, draws=False)
    if headset:
        enter_headset(page)
    trainee = place.carried_trainee((Controllers if headset else PageKeys)(page))
    trainee.begin("task-1", page)
    trainee.touch_all(TOUCHED)
    return page, trainee


def stands(place, trainee) -> bool:
    """Return whether the arm stands still."""
    before = trainee.tip
    for _ in range(20):
        place.view.next_state()
    return np.linalg.norm(trainee.tip - before) < 1e-4


@pytest.mark.soak
def test_a_broken_connection_pauses_the_trial_which_resumes_when_it_is_restored(
    place, relay, browser
):
    page, trainee = begin(place, relay, browser, "")
    trainee.hands.push(0.0, 0.0, 1.0, False)
    relay.cut()
    trainee.until(lambda: place.view.state["phase"] == "paused", "the pause")
    trainee.until(lambda: stands(place, trainee), "the arm's stop")
    trainee.hands.push(0.0, 0.0, 0.0, False)
    trainee.resume()
    assert trainee.touched == TOUCHED
    trainee.touch_all(TOUCHED + 1)
    trainee.go_home()
    page.context.close()


@pytest.mark.soak
@pytest.mark.parametrize("headset", ["", "metaQuest2"])
def test_a_stalled_network_pauses_the_trial_and_is_reported(place, relay, browser, headset):
    page, trainee = begin(place, relay, browser, headset)
    relay.stall()
    trainee.until(lambda: place.view.state["phase"] == "paused", "the pause")
    if headset:
        wait_for(page, "page.headset.panels.warning.shown.includes('was lost')")
    else:
        page.wait_for_selector(LOST)
    relay.resume()
    trainee.resume()
    assert trainee.touched == TOUCHED
    trainee.touch_all(TOUCHED + 1)
    trainee.go_home()
    page.context.close()
