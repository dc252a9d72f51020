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

PANEL = """(name) => {
  const { panels, camera } = page.headset;
  const { mesh } = panels[name];
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


def test_a_menu_stays_before_the_eyes_wherever_they_turn(menu):
    for yaw in (1.2, -1.2, 3.0):
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


SHOW_AS_PAGE = """(shown) => {
  for (const panel of document.querySelectorAll(".panel")) {
    panel.hidden = shown !== null && panel !== page.headset.panels[shown].root;
  }
  const { style } = document.getElementById("room");
  const rules = [["visibility", "visible"], ["z-index", "9"], ["background", "#fff"]];
  for (const [name, value] of rules) {
    if (shown === null) style.removeProperty(name);
    else style.setProperty(name, value, "important");
  }
}"""


@pytest.mark.parametrize("name", ["menu", "work", "menu again"])
def test_a_panel_is_drawn_as_it_is_laid_out(worn, name):
    """Otherwise the pointed part would differ from the part that is drawn."""
    name = name.split()[0]
    worn.evaluate("page.headset.showScreen(page.screen)" if name == "menu" else WORK)
    worn.evaluate(PAINTED)
    drawn = worn.evaluate(f"page.headset.panels.{name}.canvas.toDataURL()")
    drawn = Image.open(io.BytesIO(base64.b64decode(drawn.split(",")[1]))).convert("RGBA")
    size = worn.viewport_size
    worn.set_viewport_size({"width": 1100, "height": 1100})
    worn.evaluate(SHOW_AS_PAGE, name)
    clip = {"x": 0, "y": 0, "width": drawn.width, "height": drawn.height}
    laid_out = Image.open(io.BytesIO(worn.screenshot(clip=clip)))
    worn.evaluate(SHOW_AS_PAGE, None)
    worn.set_viewport_size(size)
    white = Image.new("RGBA", drawn.size, "white")
    white.alpha_composite(drawn)
    difference = np.abs(np.subtract(white.convert("L"), laid_out.convert("L"), dtype=float))
    assert (difference > 40).mean() < 0.01


def test_panels_are_readable_from_behind_the_head_too(work):
    stand(work, z=EYES_M[2] - BEHIND_M, yaw=np.pi)
    for name in ("work", "closeUp", "warning"):
        panel = work.evaluate(PANEL, name)
        assert panel["facing"] < 5.0
        assert panel["aside"] < 50.0


def test_a_banner_stays_in_the_room_and_is_not_in_the_close_up(work):
    panel = work.evaluate(PANEL, "warning")
    assert panel["isInRoom"], "the close-up is drawn without the room's panels"
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


ARROW = """(place) => {
  const { arrow, camera } = page.headset;
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


def test_an_arrow_points_to_the_next_point_where_it_is_out_of_sight(work):
    assert not work.evaluate(ARROW, work.evaluate(AHEAD % "1"))["isSeen"]
    behind = work.evaluate(AHEAD % "-1")
    arrow = work.evaluate(ARROW, behind)
    assert arrow["isSeen"]
    assert arrow["isInRoom"], "it is not drawn in the close-up"
    outward = np.subtract(behind, arrow["at"])
    assert arrow["way"] == pytest.approx(list(outward / np.linalg.norm(outward)), abs=1e-5)
    assert not work.evaluate(ARROW, None)["isSeen"]


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


def test_either_grip_moves_the_tip(worn):
    for hand in ("left", "right"):
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
