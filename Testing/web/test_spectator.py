"""A spectator in a browser, who sees through the eyes of the headset's wearer, if any."""

from __future__ import annotations

import json

import numpy as np
import pytest

from rastrainer_simulator.presentation.screen import Hint, Menu, MenuItem, Screen, ScreenMessage
from Testing.end_to_end.hands import Controllers
from Testing.end_to_end.lab import WITHOUT_GRAPHICS, Place
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient
from Testing.web.chromium import (
    PATIENCE_MS,
    accessibility_checker,
    draw_nothing,
    enter_headset,
    open_page,
    pixels,
    wait_for,
)
from Testing.web.test_page_access import VIOLATIONS

SCREEN = Screen(
    menu=Menu(
        "start",
        "RASTrainer",
        items=(
            MenuItem("train", "Train"),
            MenuItem("trainee", "ID", "text", "P07"),
            MenuItem("language", "Language", "choice", "English"),
        ),
        focus="train",
    ),
    hints=(Hint("A", "Choose", "press accept"),),
)
WORKING = Screen(instruction=ScreenMessage("Touch 3"), has_sticks=True, hints=(Hint("A", "Touch"),))
EYES = [0.2, -0.5, 1.0, 0.0, 0.0, 0.6, 0.8]
"""Turned about World's z, from looking down."""
AHEAD = (0.2, -0.5, 0.0)
UP = (-0.96, 0.28, 0.0)
HAND = [0.4, -0.2, 0.9, 0.0, 0.0, 0.0, 1.0]
LOOKS = """(() => {
  const { position, matrixWorld } = page.flat.camera;
  const axis = (column) => matrixWorld.elements.slice(4 * column, 4 * column + 3);
  return [...position.toArray(), ...axis(1), ...axis(2)];
})()"""
"""Position, up and back of the camera, three's frame."""
NOTE_WHAT_IS_SENT = """() => {
  window.sent = [];
  const { send } = WebSocket.prototype;
  WebSocket.prototype.send = function (text) { sent.push(text); send.call(this, text); };
}"""
USE_PAD = """async () => {
  page.connection.send({ type: "press", control: "touch" });
  press(0, 1);
  await frames_(3);
  press(0, 0);
  await frames_(3);
}"""


def y_up(x: float, y: float, z: float) -> tuple[float, float, float]:
    """Return a point of World in three's frame."""
    return x, z, -y


def watch(browser, served, **options):
    code = f"{served.code}&role=spectator"
    return open_page(browser, served.url, code, draws=False, has_scene=False, **options)


@pytest.fixture(scope="module")
def opened(browser, served):
    page = watch(browser, served, has_pad=True)
    yield page
    assert page.problems == []
    page.context.close()


@pytest.fixture
def page(opened, served):
    """The page of a spectator, at a menu, of whom the simulator does not know yet."""
    served.presenter.calls.clear()
    served.presenter.screen = SCREEN
    served.tell(SCREEN)
    opened.wait_for_selector("html[lang=en] body[data-menu=start]")
    return opened


def test_a_spectators_keys_clicks_gamepad_and_pointer_have_no_effect(served, page):
    page.evaluate(NOTE_WHAT_IS_SENT)
    page.evaluate(USE_PAD)
    for name in ("train", "language"):
        row = page.locator(f"#menu li[data-name={name}] button")
        assert row.get_attribute("aria-disabled") == "true"
        row.click(force=True)
    assert not page.locator("#menu input").is_editable()
    assert page.locator("#hints button").count() == 0
    for key in ("Enter", "ArrowDown", "KeyW", "Escape"):
        page.keyboard.press(key)
    served.tell(WORKING)
    page.wait_for_selector("#instruction:has-text('Touch 3')")
    assert page.locator("#touch-controls").is_hidden()
    page.mouse.move(200, 110)
    page.mouse.down(button="right")
    page.mouse.move(300, 110)
    page.mouse.up(button="right")
    page.keyboard.press("Space")
    page.evaluate("frames_(3)")
    assert page.evaluate("sent") == []
    assert served.presenter.calls == []


def test_the_pairing_form_offers_to_watch_only(browser, served):
    context = browser.new_context()
    page = context.new_page()
    draw_nothing(page)
    page.set_default_timeout(PATIENCE_MS)
    page.goto(served.url)
    page.wait_for_selector("#pairing:not([hidden])")
    page.evaluate(accessibility_checker())
    assert page.evaluate(VIOLATIONS) == []
    page.fill("#code", served.code)
    page.get_by_role("button", name="Only watch").click()
    page.wait_for_selector("body[data-watching][data-scene]")
    page.reload()
    page.wait_for_selector("body[data-watching][data-scene]")
    context.close()
    assert served.presenter.calls == []


def test_a_spectator_looks_through_the_eyes_of_the_headset_wearer(served, page):
    served.tell(WORKING)
    worn = {"type": "headsetPose", "eyes": EYES, "left": None, "right": HAND}
    with LoopThread() as thread, ViewClient(thread, served.url, served.new_key()) as headset:
        headset.join(kind="headset")
        headset.send(worn)
        wait_for(page, "page.headsetView.hands[1].visible")
        # The camera flies there: position and axes do not arrive at the same time.
        wait_for(page, _looks(*y_up(*EYES[:3]), *y_up(*UP), *y_up(0.0, 0.0, 1.0)))
        left, right = page.evaluate("page.headsetView.hands.map((hand) => hand.visible)")
        assert (left, right) == (False, True)
        wait_for(page, f"page.headsetView.hands[1].position.distanceTo({_vector(HAND)}) < 1e-4")
    wait_for(page, "!page.headsetView.hands[1].visible")
    wait_for(page, _looks(*y_up(*LOOKED_FROM)))


LOOKED_FROM = (0.5, -0.5, 0.4)
"""Where the presenter of these tests looks from."""


def _looks(*numbers: float) -> str:
    """Return whether the first of `LOOKS` are these."""
    wanted = json.dumps(numbers)
    return f"{wanted}.every((number, i) => Math.abs(number - {LOOKS}[i]) < 1e-4)"


def _vector(pose: list[float]) -> str:
    x, y, z = pose[:3]
    return f"{{ x: {x}, y: {y}, z: {z} }}"


def test_a_spectator_may_pair_to_take_part(served, page):
    page.click("#take-part")
    page.wait_for_selector("#pairing:not([hidden])")
    page.fill("#code", served.code)
    page.press("#code", "Enter")
    page.wait_for_selector("body[data-scene]:not([data-watching])")
    wait_for(page, "page.connection.isConnected")
    assert page.locator("#take-part").is_hidden()
    page.keyboard.press("KeyW")
    served.wait_for_call("on_key", _joined(served), "KeyW", True, "w")


def _joined(served) -> int:
    joined: list[int] = []

    def is_told() -> bool:
        joined[:] = [call[1] for call in served.presenter.calls if call[0] == "view_joined"]
        return bool(joined)

    wait_until(is_told, "a view")
    (number,) = joined
    return number


@pytest.mark.soak
def test_a_headset_is_mirrored_and_the_trial_pauses_when_it_leaves_despite_a_spectator(
    tmp_path, browser
):
    with Place(tmp_path, limits=WITHOUT_GRAPHICS) as place:
        url, code = place.url, place.code
        headset = open_page(browser, url, code, "metaQuest2", draws=False)
        enter_headset(headset)
        trainee = place.carried_trainee(Controllers(headset))
        trainee.begin("task-1", headset)
        page = open_page(browser, url, f"{code}&role=spectator")
        wait_for(page, "page.state?.headset != null")
        wearer = page.evaluate("page.state.headset")
        assert wearer["left"] is not None
        assert wearer["right"] is not None
        before = pixels(page)
        headset.evaluate("device.quaternion.set(0, Math.sin(0.2), 0, Math.cos(0.2)); frames_(3)")
        wait_for(page, f"Math.abs(page.state.headset.eyes[3] - {wearer['eyes'][3]}) > 0.01")
        trainee.until(lambda: np.abs(pixels(page) - before).mean() > 5.0, "another picture")
        headset.evaluate("device.updateVisibilityState('hidden')")
        wait_for(page, "page.state.headset === null")
        trainee.until(lambda: place.view.state["phase"] == "paused", "the pause")
        assert page.problems == headset.problems == []
