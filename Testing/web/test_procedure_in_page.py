"""The page and the headset draw a procedure: its tools, no-go structures, bull's-eye and ruler."""

from __future__ import annotations

import pytest

from rastrainer_simulator.net.views.screen import DepthRuler, Screen
from Testing.web.chromium import enter_headset, open_page, wait_for

RULER = DepthRuler(30.0, 37.0, 44.5, 126.0)
SEEN = """(procedure) => {
  const { model } = page.stage;
  page.showProcedure(model, { ...page.state, procedure });
  const visible = (names) => names.filter((name) => model.node(name).visible);
  const noGo = model.node("plan").children.filter((node) => node.visible);
  return {
    tools: visible(["guide", "axis", "drill", "electrode"]),
    fedM: model.node("drill").scale.z,
    noGo: noGo.map((node) => node.userData.name ?? node.name).sort(),
    isSeenThrough: noGo.every((node) => node.material.transparent),
    skin: model.node("skin").material.opacity,
    panel: !document.getElementById("guiding").hidden,
    board: page.headset?.boards.guiding.mesh.visible ?? false,
  };
}"""
PAINTED = """(procedure) => {
  const written = [];
  const { fillText } = CanvasRenderingContext2D.prototype;
  CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
    written.push(text);
    return fillText.call(this, text, x, y);
  };
  page.showProcedure(page.stage.model, { ...page.state, procedure });
  CanvasRenderingContext2D.prototype.fillText = fillText;
  return written;
}"""
STEERED = """async (procedure) => {
  const sent = [];
  const { send } = page.connection;
  page.connection.send = (type, message) => {
    if (type === "sticks" || type === "press") sent.push(structuredClone(message));
  };
  page.takeState = () => undefined;
  page.state = { ...page.state, procedure };
  const { right } = device.controllers;
  await frames_(2);
  right.updateAxes("thumbstick", 0.6, -0.5);
  await frames_(3);
  right.updateButtonValue("trigger", 1);
  await frames_(3);
  right.updateButtonValue("trigger", 0);
  right.updateAxes("thumbstick", 0, 0);
  right.updateButtonValue("b-button", 1);
  await frames_(3);
  right.updateButtonValue("b-button", 0);
  await frames_(2);
  page.connection.send = send;
  delete page.takeState;
  return sent;
}"""
AIM = {
    "entryMm": [12.0, -3.0],
    "targetMm": [4.0, 7.0],
    "entryDistanceMm": 12.37,
    "angleDeg": 6.48,
}
NOTHING = {"tools": [], "noGo": [], "skin": 1.0, "panel": False, "board": False}


def at(tool, feed_mm=0.0, aim=None):
    return {"name": "biopsy", "tool": tool, "feedMm": feed_mm, "aim": aim}


def test_the_page_shows_each_tool_with_its_panel_and_the_headset_on_a_board(served, browser):
    page = open_page(browser, served.url, served.code, "metaQuest2", draws=False)
    served.tell(Screen())
    wait_for(page, "page.stage.model !== null && page.state !== null")
    assert page.evaluate(SEEN, at("pointer")).items() >= NOTHING.items()
    served.tell(Screen(is_head_clear=True, language="de"))
    wait_for(page, "page.screen.is_head_clear")
    seen = page.evaluate(SEEN, at("guide", aim=AIM))
    assert seen["tools"] == ["guide", "axis"]
    assert seen["noGo"] == ["no_go_right-ventricle", "no_go_sagittal-sinus"]
    assert seen["isSeenThrough"]
    assert seen["skin"] < 0.5
    assert seen["panel"]
    assert page.evaluate(PAINTED, at("guide", aim={**AIM, "angleDeg": 6.61})) == [
        "12,4 mm",
        "6,6°",
    ]
    served.tell(Screen(is_head_clear=True, ruler=RULER))
    wait_for(page, "page.screen.ruler !== null")
    drilled = page.evaluate(SEEN, at("drill", 41.5))
    assert drilled["tools"] == ["guide", "drill"]
    assert drilled["fedM"] == pytest.approx(0.0415)
    written = page.evaluate(PAINTED, at("electrode", 99.96))
    assert written[0] == "100.0 mm"
    assert written[-4:] == ["30", "37", "45", "126"]
    served.presenter.screen = Screen(is_head_clear=True, ruler=RULER)
    enter_headset(page)
    worn = page.evaluate(SEEN, at("drill", 41.5))
    assert worn["board"]
    check_steering(page.evaluate(STEERED, at("guide", aim=AIM)))
    assert not page.evaluate(SEEN, at("pointer"))["tools"]
    assert page.problems == []


def check_steering(sent):
    """The right stick lifts and turns the guide; with its trigger held, it tilts it instead."""
    sticks = [each for each in sent if "translation" in each]
    lifting, tilting = sticks[0], [each for each in sticks if each["fine"]][-1]
    assert lifting["translation"][2] > 0.3
    assert lifting["rotation"] == [pytest.approx(0.545, abs=0.01), 0]
    assert tilting["translation"] == [0, 0, 0]
    assert min(tilting["rotation"]) > 0.3
    assert {"control": "undo"} in sent
