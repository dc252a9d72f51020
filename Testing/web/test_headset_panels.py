"""The headset's panels: before the eyes, facing the wearer, with room for every language."""

from __future__ import annotations

import base64
import io

import numpy as np
import pytest
from PIL import Image

from rastrainer_simulator.presentation.screen import Menu, MenuItem, Screen
from rastrainer_simulator.texts.texts import LANGUAGES
from Testing.simulator.flow.every_page import LONGEST, LONGEST_OR_EACH, letters
from Testing.web.chromium import EYES_M, enter_headset, open_page, show, stand
from Testing.web.test_page_access import at_work

BEHIND_M = 1.24
"""A step from the trainee's place to the other side of the head."""
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
PAINTED = """async () => {
  const { panels } = page.headset;
  const drawn = [panels.menu, panels.work, panels.actions, panels.warning];
  while (drawn.some((panel) => panel.isShown && !panel.isPainted)) await frames_(1);
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


TWICE = """async () => {
  const { headset, screen } = page;
  const { menu } = headset.panels;
  const work = { ...screen, menu: null };
  const other = { ...screen, menu: { ...screen.menu, title: "Another menu" } };
  const pictures = [];
  for (const shown of [screen, work, screen, other, work, screen]) {
    headset.showScreen(shown);
    await (%s)();
    pictures.push(menu.mesh.visible ? menu.canvas.toDataURL() : "");
  }
  return { isSame: pictures[0] === pictures[2] && pictures[0] === pictures[5],
           isHidden: pictures[1] === "" && pictures[4] === "",
           isOther: !["", pictures[0]].includes(pictures[3]),
           items: menu.regions.map(({ name }) => name) };
}"""


def test_a_reopened_menu_is_drawn_again(menu):
    seen = menu.evaluate(TWICE % PAINTED)
    assert (seen["isSame"], seen["isHidden"], seen["isOther"]) == (True, True, True)
    assert seen["items"] == menu.evaluate("page.screen.menu.items.map(({ name }) => name)")


BAR = """() => {
  const { menu } = page.headset.panels;
  const { x, y, width, height } =
    menu.regions.find(({ name }) => !name.startsWith("scroll "));
  const [red, , , alpha] = menu.context.getImageData(x + width + 8, y + height / 2, 1, 1).data;
  return alpha === 255 && red > 100;
}"""


def test_a_bar_shows_that_not_all_items_of_a_menu_are_visible(menu):
    menu.evaluate(PAINTED)
    assert not menu.evaluate(BAR)
    menu.evaluate("""page.headset.showScreen({ ...page.screen, menu: { ...page.screen.menu,
      items: Array.from({ length: 30 }, (_, number) => ({ ...page.screen.menu.items[0],
        name: number === 0 ? page.screen.menu.focus : `${number}` })) } })""")
    menu.evaluate(PAINTED)
    assert menu.evaluate(BAR)
    names = menu.evaluate("page.headset.panels.menu.regions.map(({ name }) => name)")
    assert menu.evaluate("page.screen.menu.focus") in names
    assert 4 <= len(names) < 30


def test_a_clock_that_runs_does_not_have_its_panel_drawn_again(work):
    at = "(time) => page.headset.showScreen({ ...page.screen, menu: null, status: [time] })"
    work.evaluate(at, "03:21")
    work.evaluate(PAINTED)
    before = work.evaluate("page.headset.panels.work.canvas.toDataURL()")
    work.evaluate(at, "03:22")
    assert work.evaluate("page.headset.panels.work.isPainted")
    assert work.evaluate("page.headset.panels.work.canvas.toDataURL()") != before


@pytest.mark.parametrize("name", ["menu", "work"])
def test_a_panel_is_drawn_as_it_is_laid_out(worn, name):
    """Otherwise the pointed part would differ from the part that is drawn."""
    worn.evaluate("page.headset.showScreen(page.screen)" if name == "menu" else WORK)
    worn.evaluate(PAINTED)
    drawn = worn.evaluate(f"page.headset.panels.{name}.canvas.toDataURL()")
    drawn = Image.open(io.BytesIO(base64.b64decode(drawn.split(",")[1]))).convert("RGBA")
    shown = "#room { visibility: visible !important; z-index: 9 !important; background: #fff }"
    sheet = worn.evaluate_handle(
        "(rule) => { document.styleSheets[0].insertRule(rule); return document.styleSheets[0]; }",
        shown,
    )
    worn.evaluate(
        "(name) => { for (const panel of document.querySelectorAll('.panel'))"
        " panel.hidden = panel !== page.headset.panels[name].root; }",
        name,
    )
    size = worn.viewport_size
    worn.set_viewport_size({"width": 1100, "height": 1100})
    laid_out = Image.open(
        io.BytesIO(
            worn.screenshot(clip={"x": 0, "y": 0, "width": drawn.width, "height": drawn.height})
        )
    )
    worn.set_viewport_size(size)
    worn.evaluate(
        "() => { for (const panel of document.querySelectorAll('.panel')) panel.hidden = false; }"
    )
    sheet.evaluate("(sheet) => sheet.deleteRule(0)")
    white = Image.new("RGBA", drawn.size, "white")
    white.alpha_composite(drawn)
    difference = np.abs(np.subtract(white.convert("L"), laid_out.convert("L"), dtype=float))
    assert (difference > 40).mean() < 0.01


@pytest.mark.parametrize("name", ["work", "closeUp", "warning"])
def test_a_panel_is_readable_from_behind_the_head_too(work, name):
    stand(work, z=EYES_M[2] - BEHIND_M, yaw=np.pi)
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
    assert [work.evaluate(IN_PHASE, phase) for phase in ("running", "idle")] == [True, False]


@pytest.mark.parametrize("hand", ["left", "right"])
def test_either_grip_moves_the_tip(worn, hand):
    squeeze = f"device.controllers.{hand}.updateButtonValue('squeeze', %d); frames_(3)"
    worn.evaluate(squeeze % 1)
    assert worn.evaluate("page.headset.grab.hand !== null")
    worn.evaluate(squeeze % 0)
    assert worn.evaluate("page.headset.grab.hand === null")


WITHOUT_ROOM = """() => {
  const { panels } = page.headset;
  const found = [];
  for (const { root, isShown } of [panels.menu, panels.work, panels.actions, panels.warning]) {
    if (!isShown) continue;
    const panel = root.getBoundingClientRect();
    const texts = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
    let count = 0;
    while (texts.nextNode()) {
      const parent = texts.currentNode.parentElement;
      if (parent.closest(".unseen") || texts.currentNode.data.trim() === "") continue;
      count++;
      const text = texts.currentNode.data;
      const size = parseFloat(getComputedStyle(parent).fontSize);
      if (size < 24) found.push(`${text} is too small to read`);
      const range = new Range();
      range.selectNodeContents(texts.currentNode);
      const isScrolled = parent.closest(".menu > ul") !== null;
      for (const box of range.getClientRects()) {
        const isAside = box.left < panel.left || box.right > panel.right;
        const isBelow = !isScrolled && box.bottom > panel.bottom - 8;
        if (isAside || isBelow) found.push(`${text} is off its panel`);
      }
    }
    if (count === 0) found.push("nothing is written");
  }
  const items = page.screen.menu?.items ?? [];
  const isLocked = items.some(({ isEnabled }) => !isEnabled);
  const choices = panels.menu.regions.filter(({ name }) => !name.startsWith("scroll "));
  if (!isLocked && items.length > 1 && choices.length < 2) {
    found.push("only one choice is in sight");
  }
  return found;
}"""


@pytest.mark.parametrize("language", LONGEST_OR_EACH)
def test_nothing_on_a_panel_is_cut_off_or_overlaps(worn, served, screens, language):
    spoken = LANGUAGES if language == LONGEST else [language]
    shown = {**screens(language), "work": max(map(at_work, spoken), key=letters)}
    found = []
    for name, screen in shown.items():
        show(worn, served, screen)
        found += [f"{name}: {each}" for each in worn.evaluate(WITHOUT_ROOM)]
    assert found == []
