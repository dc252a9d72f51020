"""The page in an emulated headset: eyes, standing position, hands, pulses, leaving and return.

Whole trials by controllers and by gamepad are in test_whole_flow.py.
"""

from __future__ import annotations

import numpy as np
import pytest

from Testing.end_to_end.hands import Controllers
from Testing.end_to_end.lab import WITHOUT_GRAPHICS, Place
from Testing.web.chromium import (
    enter_headset,
    leave_headset,
    open_page,
    pixels,
    stand,
    wait_for,
)

# A headset is drawn twice, by a machine without a graphics processor: minutes.
pytestmark = pytest.mark.soak

STEP_M = 0.03
STEPS = 5
EYES_HOME = (0.48, 0.225 + 0.45, 0.62)
"""Where the eyes belong: behind and above the middle of the head, three's frame, m."""
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
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("headset"), limits=WITHOUT_GRAPHICS) as place:
        yield place


@pytest.fixture(scope="module")
def page(place, browser):
    page = open_page(browser, place.url, place.code, "metaQuest2")
    yield page
    assert page.problems == []


@pytest.fixture
def worn(page):
    """The page in the headset, whose wearer looks straight ahead."""
    if not page.query_selector("body[data-headset]"):
        enter_headset(page)
    stand(page)
    return page


@pytest.fixture
def trainee(place, worn):
    """A trainee in the headset at a running trial, the tip over the first point.

    Release all held inputs, even if the test has failed.
    """
    trainee = place.carried_trainee(Controllers(worn))
    if trainee.menu is not None and trainee.menu.name == "trial":
        trainee.resume()
    if place.view.state["phase"] != "running":
        trainee.begin("task-1", worn)
    trainee.approach("1", 0.004)
    yield trainee
    trainee.hands.grab(False)
    trainee.hands.push(0.0, 0.0, 0.0)


def eyes(page) -> list[np.ndarray]:
    return [np.array(values).reshape(4, 4).T for values in page.evaluate(EYES)]


def eye_place(page) -> np.ndarray:
    """Return the middle between both eyes, in three's frame, m."""
    return np.mean([matrix[:3, 3] for matrix in eyes(page)], axis=0)


def forward(page) -> np.ndarray:
    return -eyes(page)[0][:3, 2]


def wait_for_arm_to_rest(page, trainee) -> None:
    """Wait until the arm stands, and is seen where it stands."""
    trainee.until_still()
    page.evaluate("frames_(3)")


def test_the_menu_and_the_headsets_own_button_recenter_at_the_table_from_anywhere(place, worn):
    place.carried_trainee(Controllers(worn)).go_home()
    stand(worn, 0.7, 1.1, -0.4, yaw=0.6)
    assert np.linalg.norm(eye_place(worn) - EYES_HOME) > 0.3
    Controllers(worn).point_at("local recenter")
    np.testing.assert_allclose(eye_place(worn), EYES_HOME, atol=0.01)
    np.testing.assert_allclose(forward(worn), (0.0, 0.0, -1.0), atol=0.02)
    stand(worn, 0.3, 1.9, 0.9, yaw=-1.0)
    worn.evaluate("device.recenter(); frames_(3)")
    np.testing.assert_allclose(eye_place(worn), EYES_HOME, atol=0.01)


def test_the_table_can_be_raised_and_lowered_and_stays_there(place, worn):
    place.carried_trainee(Controllers(worn)).go_home()
    hands = Controllers(worn)
    hands.point_at("local recenter")
    hands.point_at("local higher")
    hands.point_at("local higher")
    # A table that is higher is nearer to the eyes.
    raised = np.subtract(EYES_HOME, (0.0, 2 * STEP_M, 0.0))
    np.testing.assert_allclose(eye_place(worn), raised, atol=0.01)
    leave_headset(worn)
    enter_headset(worn)
    np.testing.assert_allclose(eye_place(worn), raised, atol=0.01)
    hands.point_at("local lower")
    hands.point_at("local lower")
    np.testing.assert_allclose(eye_place(worn), EYES_HOME, atol=0.01)


def test_the_tip_follows_the_grabbing_hand_until_it_lets_go_unless_that_is_switched_off(
    place, worn, trainee
):
    hands = trainee.hands
    wait_for_arm_to_rest(worn, trainee)
    wanted = trainee.tip
    hands.grab(True)
    for _ in range(STEPS):
        wanted = wanted + hands.move(0.006, 0.008, 0.004)
        trainee.until(lambda w=wanted: np.linalg.norm(trainee.tip - w) < 0.006, "the tip there")
    hands.grab(False)
    wait_for_arm_to_rest(worn, trainee)
    held = trainee.tip
    check_not_followed(place, trainee, held)
    switch_grab(trainee)
    hands.grab(True)
    check_not_followed(place, trainee, held)
    hands.grab(False)
    switch_grab(trainee)


def check_not_followed(place, trainee, held):
    trainee.hands.move(-0.03, 0.04, -0.02)
    for _ in range(30):
        place.view.next_state()
    assert np.linalg.norm(trainee.tip - held) < 0.002


def switch_grab(trainee):
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    trainee.hands.point_at("local grab")
    trainee.resume()
    trainee.until_still()


class Wand:
    """A wand whose touchpad is pressed, at its upper end to undo."""

    def __init__(self, page):
        self._page = page

    def tap(self, control):
        self._page.evaluate(
            """async (down) => {
              wand.axes[1] = down; wand.buttons[2].value = 1; await frames_(2);
              wand.axes.fill(0); wand.buttons[2].value = 0; await frames_(2); }""",
            {"touch": 0.0, "undo": -0.9}[control],
        )


def test_a_wand_without_further_buttons_touches_and_undoes(worn, trainee):
    worn.evaluate(
        """() => {
          const buttons = Array.from({ length: 3 }, () => ({ value: 0, pressed: false }));
          window.wand = { axes: [0, 0], buttons };
          const hand = page.headset.hands.hands.find(({ source }) => source.handedness === "right");
          window.held = [hand, hand.source];
          const { handedness, targetRayMode } = hand.source;
          hand.source = { handedness, targetRayMode, gamepad: wand }; }"""
    )
    controllers, before = trainee.hands, trainee.touched
    trainee.lower_onto("1")
    trainee.hands = Wand(worn)
    try:
        trainee.press("touch", lambda: trainee.touched == before + 1, "the touch")
        trainee.press("undo", lambda: trainee.touched == before, "the undo")
    finally:
        trainee.hands = controllers
        worn.evaluate("() => { const [hand, source] = held; hand.source = source; }")


def test_proximity_pulses_both_controllers(worn, trainee):
    worn.evaluate(LISTEN_TO_PULSES)
    trainee.steer_to(trainee.place_of("1"), 0.002)
    wait_for(worn, "pulses.length >= 2")
    pulses = worn.evaluate("pulses")
    assert {hand for hand, _value, _ms in pulses} == {"left", "right"}
    assert all(0 < value <= 1 and ms > 0 for _hand, value, ms in pulses)


@pytest.mark.parametrize("leaves", [False, True], ids=["taken off", "session left"])
def test_a_headset_that_is_taken_off_or_left_pauses_the_trial_and_loses_nothing(
    place, worn, trainee, leaves
):
    trainee.touch_all(1)
    trainee.hands.push(0.0, 0.0, 0.8)
    trainee.until(lambda: place.view.state["clearanceMm"] > 40, "the tip off the head")
    if leaves:
        leave_headset(worn)
    else:
        worn.evaluate("device.updateVisibilityState('hidden')")
    trainee.until(lambda: place.view.state["phase"] == "paused", "the pause")
    held = trainee.tip
    for _ in range(30):
        place.view.next_state()
    assert np.linalg.norm(trainee.tip - held) < 0.01
    trainee.hands.push(0.0, 0.0, 0.0)
    if leaves:
        enter_headset(worn)
    else:
        worn.evaluate("device.updateVisibilityState('visible')")
    trainee.resume()
    assert trainee.touched == 1
    trainee.press("undo", lambda: trainee.touched == 0, "the undo")


def test_both_eyes_see_the_room_and_a_quest_3_is_known_by_its_name(place, browser):
    page = open_page(browser, place.url, place.code, "metaQuest3")
    enter_headset(page)
    picture = pixels(page)
    middle = picture.shape[1] // 2
    assert all(half.std() > 20.0 for half in (picture[:, :middle], picture[:, middle:]))
    assert page.evaluate("page.headset.hello().device") == "Meta Quest 3"
    assert page.evaluate("page.stage.renderer.xr.getFoveation()") in (1, None)
    page.context.close()
