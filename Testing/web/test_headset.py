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

IPD_M = 0.063
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


def halves(picture: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    middle = picture.shape[1] // 2
    return picture[:, :middle], picture[:, middle : 2 * middle]


def test_two_eyes_are_a_pupil_distance_apart_and_see_the_room(worn):
    left, right = eyes(worn)
    between = right[:3, 3] - left[:3, 3]
    np.testing.assert_allclose(np.linalg.norm(between), IPD_M, atol=0.003)
    assert between @ left[:3, 0] > 0.99 * np.linalg.norm(between)
    for half in halves(pixels(worn)):
        assert half.std() > 20.0

    left, right = (half.mean(axis=2)[100:] for half in halves(pixels(worn)))
    width = left.shape[1]
    costs = {
        shift: np.abs(left[:, 24 + shift : width - 24 + shift] - right[:, 24 : width - 24]).mean()
        for shift in range(-20, 21)
    }
    assert min(costs, key=costs.get) > 0


def test_the_view_turns_with_the_head(worn):
    straight, seen = forward(worn), pixels(worn)
    stand(worn, yaw=0.4)
    np.testing.assert_allclose(np.arccos(straight @ forward(worn)), 0.4, atol=0.02)
    assert np.abs(pixels(worn) - seen).mean() > 5.0


@pytest.mark.parametrize("height", [1.1, 1.9])
def test_sitting_and_standing_users_recenter_to_the_same_place_at_the_table(place, worn, height):
    trainee = place.carried_trainee(Controllers(worn))
    trainee.go_home()
    stand(worn, 0.7, height, -0.4, yaw=0.6)
    assert np.linalg.norm(eye_place(worn) - EYES_HOME) > 0.3
    Controllers(worn).point_at("local recenter")
    np.testing.assert_allclose(eye_place(worn), EYES_HOME, atol=0.01)
    np.testing.assert_allclose(forward(worn), (0.0, 0.0, -1.0), atol=0.02)


def test_the_headsets_own_button_recenters_too(worn):
    stand(worn, 0.3, 1.4, 0.9, yaw=-1.0)
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


def test_the_sticks_follow_the_eyes(worn, trainee):
    wait_for_arm_to_rest(worn, trainee)
    start = trainee.tip
    # A quarter turn to the right: the eyes look along World's x.
    worn.evaluate("device.quaternion.set(0, -Math.SQRT1_2, 0, Math.SQRT1_2); frames_(3)")
    trainee.hands.push(0.0, 1.0, 0.3)
    trainee.until(lambda: np.linalg.norm((trainee.tip - start)[:2]) > 0.02, "a step forward")
    trainee.hands.push(0.0, 0.0, 0.0)
    worn.evaluate("device.quaternion.set(0, 0, 0, 1); frames_(3)")
    ahead, aside = (trainee.tip - start)[:2]
    assert ahead > 0.02
    assert abs(aside) < 0.2 * ahead


class Wand:
    """A wand whose touchpad or stick is pressed, at its upper end to undo."""

    def __init__(self, page, button):
        self._page, self._button = page, button

    def tap(self, control):
        self._page.evaluate(
            """async ([index, down]) => {
              wand.axes[wand.axes.length - 1] = down;
              wand.buttons[index].value = 1; await frames_(2);
              wand.axes.fill(0); wand.buttons[index].value = 0; await frames_(2); }""",
            [self._button, {"touch": 0.0, "undo": -0.9}[control]],
        )


@pytest.mark.parametrize(("buttons", "button"), [(3, 2), (4, 3)], ids=["touchpad", "stick"])
def test_a_wand_without_further_buttons_touches_and_undoes(worn, trainee, buttons, button):
    worn.evaluate(
        """(count) => {
          const buttons = Array.from({ length: count }, () => ({ value: 0, pressed: false }));
          window.wand = { axes: count === 3 ? [0, 0] : [0, 0, 0, 0], buttons };
          const hand = page.headset.hands.hands.find(({ source }) => source.handedness === "right");
          window.held = [hand, hand.source];
          const { handedness, targetRayMode } = hand.source;
          hand.source = { handedness, targetRayMode, gamepad: wand }; }""",
        buttons,
    )
    controllers, before = trainee.hands, trainee.touched
    trainee.lower_onto("1")
    trainee.hands = Wand(worn, button)
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


def test_the_holder_of_control_is_shown_while_driving_and_in_menus(worn, trainee):
    holder = "You drive: headset's controllers"
    trainee.press("camera", lambda: trainee.view.state["camera"] == "far", "the far camera")
    wait_for(worn, f"page.headset.panels.work.root.textContent.includes(`{holder}`)")
    trainee.press("camera", lambda: trainee.view.state["camera"] != "far", "the close camera")
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    wait_for(worn, f"page.headset.panels.actions.root.textContent.includes(`{holder}`)")


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


def test_the_journal_records_mode_headset_rate_and_frames(place, trainee):
    (begun,) = place.entries("header")
    assert begun["mode"] == "hmd"

    def reports_of_headset() -> list[dict]:
        # Some earlier reports came from the page, or before the first picture.
        reports = place.entries("display")
        return [each for each in reports if each["view"] == "headset" and each["shown"] > 0]

    trainee.until(reports_of_headset, "a report of the headset's frames")
    report = reports_of_headset()[-1]
    assert (report["device"], report["refreshHz"]) == ("Meta Quest 2", 90)
    assert report["dropped"] >= 0


def test_a_quest_3_is_recognized_by_its_name_and_drawn_with_maximum_foveation(place, browser):
    page = open_page(browser, place.url, place.code, "metaQuest3")
    enter_headset(page)
    assert page.evaluate("page.headset.hello().device") == "Meta Quest 3"
    assert page.evaluate("page.stage.renderer.xr.getFoveation()") in (1, None)
    assert all(half.std() > 20.0 for half in halves(pixels(page)))
    page.context.close()
