"""The page in an emulated headset: both eyes, the whole flow by controllers, leaving and back."""

from __future__ import annotations

import numpy as np
import pytest

from Testing.web.chromium import enter_headset, open_page, pixels
from Testing.web.hands import Controllers
from Testing.web.place import Place, scored_trial

pytestmark = pytest.mark.soak

IPD_M = 0.063
EYES = """(() => {
  const eyes = page.stage.renderer.xr.getCamera().cameras;
  return eyes.map((eye) => eye.matrixWorld.toArray());
})()"""
LISTEN_TO_PULSES = """(() => {
  window.pulses = [];
  for (const source of page.headset.session.inputSources) {
    source.gamepad.hapticActuators[0].pulse = async (value, ms) => {
      pulses.push([source.handedness, value, ms]);
      return true;
    };
  }
})()"""


@pytest.fixture(scope="module")
def session(tmp_path_factory, browser) -> dict:
    """Train one task in a Quest 2, and leave and come back in its middle."""
    told: dict = {}
    with Place(tmp_path_factory.mktemp("headset"), "--speed", "4") as place:
        page = open_page(browser, place.simulator.url, place.simulator.code, "metaQuest2")
        trainee = place.trainee(Controllers(page))
        enter_headset(page)
        page.evaluate(LISTEN_TO_PULSES)
        told["eyes"] = eyes(page)
        told["picture"] = pixels(page)
        page.evaluate("device.quaternion.set(0, Math.sin(0.2), 0, Math.cos(0.2)); frames_(3)")
        told["eyes turned"] = eyes(page)
        told["picture turned"] = pixels(page)
        page.evaluate("device.quaternion.set(0, 0, 0, 1)")
        trainee.begin("task-1", page)
        trainee.touch_all(2)
        told["pulses"] = page.evaluate("pulses")
        told["touched before leaving"] = trainee.touched
        page.evaluate("page.headset.leave()")
        trainee.until(lambda: place.view.state["phase"] == "paused", "the pause")
        page.wait_for_selector("body:not([data-headset])")
        enter_headset(page)
        trainee.choose("resume")
        trainee.until(lambda: place.view.state["phase"] == "running", "the trial again")
        told["touched after coming back"] = trainee.touched
        trainee.touch_all(3)
        trainee.have_touched(14)
        trainee.touch_all()
        slicer = place.start_slicer()
        trainee.press("touch", lambda: trainee.menu is not None, "the choice")
        trainee.choose("register")
        told["trial"] = scored_trial(slicer)
        trainee.until_menu("result")
        told["menu"] = trainee.menu
        told["entries"] = place.entries()
        told["problems"] = page.problems
    return told


def eyes(page) -> list[np.ndarray]:
    return [np.array(values).reshape(4, 4).T for values in page.evaluate(EYES)]


def halves(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    middle = picture.shape[1] // 2
    return picture[:, :middle], picture[:, middle : 2 * middle]


def test_two_eyes_stand_a_pupil_distance_apart_and_see_the_room(session):
    left, right = session["eyes"]
    between = right[:3, 3] - left[:3, 3]
    np.testing.assert_allclose(np.linalg.norm(between), IPD_M, atol=0.003)
    assert between @ left[:3, 0] > 0.99 * np.linalg.norm(between)
    for half in halves(session["picture"]):
        assert half.std() > 20.0


def test_what_one_eye_sees_lies_farther_right_than_what_the_other_sees(session):
    left, right = (half.mean(axis=2)[100:] for half in halves(session["picture"]))
    width = left.shape[1]
    costs = {
        shift: np.abs(left[:, 24 + shift : width - 24 + shift] - right[:, 24 : width - 24]).mean()
        for shift in range(-20, 21)
    }
    assert min(costs, key=costs.get) > 0


def test_the_view_turns_with_the_head(session):
    forward, turned = (-session[name][0][:3, 2] for name in ("eyes", "eyes turned"))
    np.testing.assert_allclose(np.degrees(np.arccos(forward @ turned)), np.degrees(0.4), atol=1.0)
    assert np.abs(session["picture"] - session["picture turned"]).mean() > 5.0


def test_the_trainee_stands_at_the_table_whatever_their_height(session):
    eye = np.mean([matrix[:3, 3] for matrix in session["eyes"]], axis=0)
    np.testing.assert_allclose(eye, (0.48, 0.225 + 0.45, 0.62), atol=0.01)


def test_proximity_pulses_both_controllers(session):
    assert {hand for hand, _value, _ms in session["pulses"]} == {"left", "right"}
    assert all(0 < value <= 1 and ms > 0 for _hand, value, ms in session["pulses"])


def test_leaving_the_headset_pauses_the_trial_and_loses_nothing(session):
    assert session["touched before leaving"] == session["touched after coming back"] == 2


def test_a_trial_by_controllers_is_registered_and_scored(session):
    assert session["trial"]["mode"] == "hmd"
    assert session["menu"].facts[0].label == "Score"
    assert session["problems"] == []


def test_the_record_tells_mode_headset_rate_and_frames(session):
    kinds = [entry["kind"] for entry in session["entries"]]
    record = session["entries"][kinds.index("registered")]["record"]
    assert record["mode"] == "hmd"
    display = record["display"]
    assert (display["kind"], display["device"]) == ("headset", "Meta Quest 2")
    assert display["refreshHz"] == 90
    assert display["shownFrames"] > 0
    assert display["droppedFrames"] >= 0


def test_a_quest_3_is_told_by_its_name(tmp_path, browser):
    with Place(tmp_path) as place:
        page = open_page(browser, place.simulator.url, place.simulator.code, "metaQuest3")
        enter_headset(page)
        assert page.evaluate("page.headset.hello().device") == "Meta Quest 3"
        assert page.evaluate("page.stage.renderer.xr.getFoveation()") in (1, None)
        assert all(half.std() > 20.0 for half in halves(pixels(page)))
