"""The headset's panels: before the eyes, facing the wearer, with room for every language."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.presentation.screen import Menu, MenuItem, Screen
from rastrainer_simulator.texts.texts import LANGUAGES
from Testing.simulator.flow.languages import LONGEST, LONGEST_OR_EACH, letters, screens_in
from Testing.web.chromium import EYES_M, enter_headset, open_page, show
from Testing.web.test_page_access import at_work

BEHIND_M = 1.24
"""From where the trainee stands to the other side of the head."""
TURNED = (0.0, 1.2, -1.2, 3.0)

PANEL = """(name) => {
  const { panels, camera } = page.headset;
  const mesh = name === "closeUp" ? panels.closeUp.mesh : panels[name].mesh;
  const eyes = camera.getWorldPosition(mesh.position.clone());
  const place = mesh.getWorldPosition(mesh.position.clone());
  const away = place.clone().sub(eyes);
  const gaze = camera.getWorldDirection(mesh.position.clone());
  const front = mesh.getWorldDirection(mesh.position.clone());
  const degrees = (one, other) => one.angleTo(other) * 180 / Math.PI;
  const level = (vector) => vector.clone().setY(0);
  return { aside: degrees(level(gaze), level(away)), facing: degrees(front, away.clone().negate()),
           away: away.length(), isInRoom: mesh.parent === panels.room };
}"""
WORK = """() => {
  const hint = (control) => ({ control, action: "A longer action of it" });
  page.headset.showScreen({ ...page.screen, menu: null, status: ["Task 1", "7 of 15", "03:21"],
    instruction: { text: "P7, touch the point number 7, which is over there.", tone: "plain" },
    warnings: [{ text: "The arm is too close to the head.", tone: "error" }],
    hints: ["A", "B", "Trigger", "Y", "X"].map(hint) });
}"""
COVERED = """() => {
  const { panels, camera } = page.headset;
  const { mesh } = panels.warning;
  const eyes = camera.getWorldPosition(mesh.position.clone());
  const size = mesh.geometry.parameters;
  const bottom = mesh.localToWorld(mesh.position.clone().set(0, -size.height / 2, 0)).sub(eyes);
  const head = page.stage.model.node("head");
  const model = page.stage.model;
  const up = (vector) => Math.atan2(vector.y, Math.hypot(vector.x, vector.z));
  const box = new (page.headset.placement.rig.constructor)();
  let highest = -2;
  head.traverse((node) => {
    const places = node.geometry?.getAttribute("position");
    if (!places) return;
    for (let index = 0; index < places.count; index += 7) {
      const place = mesh.position.clone().fromBufferAttribute(places, index);
      highest = Math.max(highest, up(node.localToWorld(place).sub(eyes)));
    }
  });
  return up(bottom) < highest;
}"""
WRITTEN = """() => {
  const written = [];
  const { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
    if (this.canvas === page.headset.panels.work.context.canvas) written.push([text, y]);
    return fillText.call(this, text, x, y);
  };
  (%s)();
  CanvasRenderingContext2D.prototype.fillText = fillText;
  return written;
}"""


MENU = Screen(
    menu=Menu("start", "RASTrainer", items=(MenuItem("train", "Train"), MenuItem("quit", "Quit")))
)


@pytest.fixture(scope="module")
def worn(browser, served):
    served.presenter.screen = MENU
    page = open_page(browser, served.url, served.code, "metaQuest2", draws=False)
    enter_headset(page)
    yield page
    assert page.problems == []


@pytest.fixture
def menu(worn):
    """The wearer at a menu, where they belong."""
    worn.evaluate("page.headset.showScreen(page.screen)")
    return stand(worn)


@pytest.fixture
def work(worn):
    """The wearer at a screen of a trial, with a warning and as many hints as there are."""
    worn.evaluate(WORK)
    return stand(worn)


def stand(page, forward=0.0, yaw=0.0):
    """Have the wearer stand so far from their starting position, and look there."""
    page.evaluate(
        """async ([x, y, z, half]) => {
          device.position.set(x, y, z);
          device.quaternion.set(0, Math.sin(half), 0, Math.cos(half));
          await frames_(4); }""",
        [EYES_M[0], EYES_M[1], EYES_M[2] - forward, yaw / 2],
    )
    return page


@pytest.mark.parametrize("yaw", TURNED)
def test_a_menu_stays_before_the_eyes_wherever_they_turn(menu, yaw):
    stand(menu, yaw=yaw)
    panel = menu.evaluate(PANEL, "menu")
    assert panel["aside"] < 35.0
    assert panel["facing"] < 5.0
    assert panel["away"] < 0.7, "nearer than the arm"


def test_a_menu_opens_where_the_eyes_look(work):
    stand(work, yaw=0.5)
    work.evaluate("page.headset.showScreen(page.screen)")
    work.evaluate("frames_(3)")
    assert work.evaluate(PANEL, "menu")["aside"] < 2.0


TWICE = """() => {
  const { headset, screen } = page;
  const { menu } = headset.panels;
  const work = { ...screen, menu: null };
  const other = { ...screen, menu: { ...screen.menu, title: "Another menu" } };
  const pictures = [screen, work, screen, other, work, screen].map((shown) => {
    headset.showScreen(shown);
    return menu.mesh.visible ? menu.context.canvas.toDataURL() : "";
  });
  return { isSame: pictures[0] === pictures[2] && pictures[0] === pictures[5],
           isHidden: pictures[1] === "" && pictures[4] === "",
           isOther: !["", pictures[0]].includes(pictures[3]),
           items: menu.regions.map(({ name }) => name) };
}"""


def test_a_reopened_menu_is_drawn_again(menu):
    seen = menu.evaluate(TWICE)
    assert (seen["isSame"], seen["isHidden"], seen["isOther"]) == (True, True, True)
    assert seen["items"] == menu.evaluate("page.screen.menu.items.map(({ name }) => name)")


BAR = """() => {
  const { menu } = page.headset.panels;
  const { width } = menu.context.canvas;
  const { y, height } = menu.regions[0];
  const [red] = menu.context.getImageData(width - 24, y + height / 2, 1, 1).data;
  return red > 100;
}"""


def test_a_bar_shows_that_not_all_items_of_a_menu_are_visible(menu):
    assert not menu.evaluate(BAR)
    menu.evaluate("""page.headset.showScreen({ ...page.screen, menu: { ...page.screen.menu,
      items: Array.from({ length: 30 }, (_, number) => ({ ...page.screen.menu.items[0],
        name: number === 0 ? page.screen.menu.focus : `${number}` })) } })""")
    assert menu.evaluate(BAR)


@pytest.mark.parametrize("name", ["work", "closeUp", "warning"])
def test_a_panel_is_readable_from_behind_the_head_too(work, name):
    stand(work, forward=BEHIND_M, yaw=3.14159)
    panel = work.evaluate(PANEL, name)
    assert panel["facing"] < 5.0
    assert panel["aside"] < 50.0


def test_a_banner_is_in_the_room_above_the_head_and_not_in_the_close_up(work):
    panel = work.evaluate(PANEL, "warning")
    assert panel["isInRoom"], "the close-up is drawn without the room's panels"
    assert not work.evaluate(COVERED)
    before = work.evaluate("page.headset.panels.warning.mesh.position.toArray()")
    stand(work, yaw=0.3)
    assert work.evaluate("page.headset.panels.warning.mesh.position.toArray()") == before


CLOSE_UP = """async (inset) => {
  const { headset, stage } = page;
  const { closeUp, room } = headset.panels;
  for (let turn = 0; turn < 3; turn++) closeUp.draw(stage, room, { ...page.state, inset });
  const { x, y, z } = closeUp.camera.position;
  return [[x, -z, y], closeUp.camera.fov];
}"""
BEHIND = {
    "position": [0.2, 0.1, 0.4],
    "focalPoint": [0.3, 0.0, 0.4],
    "viewUp": [0, 0, 1],
    "viewAngleDeg": 17,
}


def test_the_close_up_looks_along_the_skin_wherever_the_next_touch_is(work):
    place, angle = work.evaluate(CLOSE_UP, BEHIND)
    assert (place, angle) == (pytest.approx(BEHIND["position"]), 17)
    place, angle = work.evaluate(CLOSE_UP, None)
    front = work.evaluate("page.scene.cameras['close-up'].position")
    assert (place, angle) == (pytest.approx(front), 10)


ARROW = """([name, place]) => {
  const { [name]: arrow, camera } = page.headset;
  arrow.show(place === null ? null : camera.position.clone().fromArray(place), camera);
  const up = arrow.group.position.clone().set(0, 1, 0).applyQuaternion(arrow.group.quaternion);
  const { x, y, z } = arrow.group.position;
  return { isSeen: arrow.group.visible, way: [up.x, -up.z, up.y], at: [x, -z, y],
           isInRoom: arrow.group.parent === page.headset.panels.room };
}"""
AHEAD = """() => {
  const { camera } = page.headset;
  const eyes = camera.getWorldPosition(camera.position.clone());
  const place = eyes.clone().addScaledVector(camera.getWorldDirection(camera.position.clone()), %s);
  return [place.x, -place.z, place.y];
}"""


@pytest.mark.parametrize("name", ["arrow", "toolArrow"])
def test_arrows_point_to_the_next_point_and_the_tool_where_they_are_out_of_sight(work, name):
    assert not work.evaluate(ARROW, [name, work.evaluate(AHEAD % "1")])["isSeen"]
    behind = work.evaluate(AHEAD % "-1")
    arrow = work.evaluate(ARROW, [name, behind])
    assert arrow["isSeen"]
    assert arrow["isInRoom"], "it is not drawn in the close-up"
    outward = np.subtract(behind, arrow["at"])
    assert arrow["way"] == pytest.approx(list(outward / np.linalg.norm(outward)), abs=1e-5)
    assert not work.evaluate(ARROW, [name, None])["isSeen"]


IN_PHASE = """async (phase) => {
  page.takeState = () => undefined;
  page.state = { ...page.state, phase };
  await frames_(3);
  delete page.takeState;
  return page.headset.toolArrow.group.visible;
}"""


def test_who_looks_away_from_the_head_in_a_trial_sees_where_the_tool_is(work):
    assert not work.evaluate(IN_PHASE, "running")
    stand(work, yaw=np.pi)
    assert work.evaluate(IN_PHASE, "running")
    assert not work.evaluate(IN_PHASE, "idle")


def test_hints_and_control_holder_are_on_separate_lines(worn):
    worn.evaluate("page.headset.panels.work.shown = ''")
    written = worn.evaluate(WRITTEN % WORK)
    (holder,) = [y for text, y in written if "robot" in text]
    hints = [y for text, y in written if text in ("X", "A longer action of it")]
    assert hints
    assert all(abs(y - holder) > 40 for y in hints)


@pytest.mark.parametrize("hand", ["left", "right"])
def test_either_grip_moves_the_tip(worn, hand):
    squeeze = f"device.controllers.{hand}.updateButtonValue('squeeze', %d); frames_(3)"
    worn.evaluate(squeeze % 1)
    assert worn.evaluate("page.headset.grab.hand !== null")
    worn.evaluate(squeeze % 0)
    assert worn.evaluate("page.headset.grab.hand === null")


WITHOUT_ROOM = """() => {
  const written = [];
  const { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
    const right = x + this.measureText(text).width;
    const size = parseFloat(/([\\d.]+)px/.exec(this.font)[1]);
    written.push({ text, canvas: this.canvas, left: x, right, y, size });
    return fillText.call(this, text, x, y);
  };
  const { panels } = page.headset;
  for (const panel of [panels.menu, panels.work, panels.actions, panels.warning]) panel.shown = "";
  page.headset.showScreen(page.screen);
  CanvasRenderingContext2D.prototype.fillText = fillText;
  const found = written.length > 0 ? [] : ["nothing is written"];
  const items = page.screen.menu?.items ?? [];
  const isLocked = items.some(({ isEnabled }) => !isEnabled);
  if (!isLocked && items.length > 1 && panels.menu.regions.length < 2) {
    found.push("only one choice is in sight");
  }
  written.forEach((one, index) => {
    // Texts of its own that end so have a space before the dots.
    if (/[^ ]…$/.test(one.text)) found.push(`${one.text} is cut`);
    if (one.size < 24) found.push(`${one.text} is too small to read`);
    const { width, height } = one.canvas;
    const isOff = one.left < 0 || one.right > width || one.y > height - 8;
    if (isOff) found.push(`${one.text} is off its panel`);
    for (const other of written.slice(index + 1)) {
      const isBeside = one.canvas === other.canvas && Math.abs(one.y - other.y) < 20;
      const across = Math.min(one.right, other.right) - Math.max(one.left, other.left);
      if (isBeside && across > 0) found.push(`${one.text} over ${other.text}`);
    }
  });
  return found;
}"""


@pytest.mark.parametrize("language", LONGEST_OR_EACH)
def test_nothing_on_a_panel_is_cut_off_or_overlaps(worn, served, loop, outside, language):
    presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
    spoken = LANGUAGES if language == LONGEST else [language]
    screens = {**screens_in(presenter, language), "work": max(map(at_work, spoken), key=letters)}
    found = []
    for name, screen in screens.items():
        show(worn, served, screen)
        found += [f"{name}: {each}" for each in worn.evaluate(WITHOUT_ROOM)]
    presenter.close()
    assert found == []
