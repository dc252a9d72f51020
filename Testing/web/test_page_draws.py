"""The page draws touches, ghost, trace and procedure in its scene, and in a headset, too."""

from __future__ import annotations

import pytest

from rastrainer_simulator.presentation.messages import SkinPlace, TraceNews, message_text
from rastrainer_simulator.presentation.presenter import TraceGuidance
from rastrainer_simulator.presentation.screen import DepthRuler, Screen, ScreenMessage
from rastrainer_simulator.state import TOUCH_ERRORS, TouchStage
from Testing.web.chromium import enter_headset, open_page, show, wait_for


@pytest.fixture(scope="module")
def page(browser, served):
    page = open_page(browser, served.url, served.code, "metaQuest2", draws=False)
    page.evaluate("delete page.flat.draw")
    page.evaluate("frames_(2)")
    yield page
    assert page.problems == []


RED = 0xC7001A
DRAW = """
(changes) => {
  const state = { ...page.state, ...changes };
  page.isDue = true;
  page.ghost.put(state.timeS, state.ghost, 1);
  // Milliseconds for seconds: by then the camera has arrived wherever it was sent.
  page.drawFlat(page.flat, performance.now(), page.stage.model, state);
  return {
    ring: page.ring.mesh.visible ? page.ring.mesh.scale.x : 0,
    color: page.ring.material.color.getHex(),
    tip: page.stage.model.tip.color.getHex(),
    isFramed: !document.getElementById("contact").hidden,
    ghost: page.ghost.doubles.map((double) => double.position.toArray()),
    hasArrow: !document.getElementById("tool").hidden,
    clear: [...document.querySelectorAll(".clear")].map((panel) => panel.id),
  };
}
"""


@pytest.fixture
def draw(page):
    """Return a function that draws a state with some changes and returns the visible marks."""
    return lambda **changes: page.evaluate(DRAW, changes)


def test_tip_ring_and_frame_are_red_only_while_a_touch_goes_wrong(draw):
    for stage in TouchStage:
        seen = draw(touch=stage.value, clearanceMm=0.0)
        is_wrong = stage in TOUCH_ERRORS
        assert seen["isFramed"] is is_wrong
        assert (seen["tip"] == RED) is is_wrong
        assert (seen["ring"] > 0) is (stage is not TouchStage.FAR)
        if seen["ring"]:
            assert (seen["color"] == RED) is is_wrong
    # The ring closes as the tip comes nearer.
    radii = [draw(touch="near", clearanceMm=clearance)["ring"] for clearance in (20.0, 10.0, 0.0)]
    assert radii == pytest.approx([0.025, 0.015, 0.005])


def test_a_ghost_is_where_the_stream_places_it_and_disappears_when_it_ends(draw):
    assert draw()["ghost"] == []
    poses = {"link_7": [0.4, 0.1, 0.7, 0, 0, 0, 1], "tool": [0.4, 0.1, 0.5, 0, 0, 0, 1]}
    assert draw(ghost=poses)["ghost"] == [pytest.approx(pose[:3]) for pose in poses.values()]
    assert draw()["ghost"] == []


SEEN_THROUGH = """
() => {
  const { model, renderer } = page.stage;
  const drawn = [];
  const before = renderer.render;
  const isClear = ([, meshes]) => meshes.some(([mesh]) => mesh.material.transparent);
  renderer.render = (_scene, { layers }) => {
    const drawsArm = layers.isEnabled(0);
    if (drawsArm) drawn.push([...model.arm].filter(isClear).map(([name]) => name));
  };
  const translucent = { view: ["link_5", "tool"], inset: ["link_6"], headset: [] };
  page.isDue = true;
  page.drawFlat(page.flat, 1, model, { ...page.state, translucent });
  renderer.render = before;
  return drawn;
}
"""


def test_each_picture_shows_translucent_what_covers_tip_or_point_in_it(page, draw):
    assert page.evaluate(SEEN_THROUGH) == [["link_5", "tool"], ["link_6"]]
    draw()
    own = "[...page.stage.model.arm.values()].flat().some(([mesh]) => mesh.material.transparent)"
    assert page.evaluate(own) is False


def looked_at(page, offset_m):
    """Return a camera that sees the tip so far above the middle of its picture."""
    x, y, z = page.evaluate("page.stage.model.node('tool').position.toArray()")
    middle = [x, y, z - offset_m]
    place = {"position": [x, y - 0.6, middle[2]], "focalPoint": middle}
    return {**place, "viewUp": [0, 0, 1], "viewAngleDeg": 30}


def test_an_arrow_points_to_a_tool_out_of_sight_and_no_panel_covers_the_tip(page, served, draw):
    show(page, served, Screen(instruction=ScreenMessage("Touch point 1.")))
    is_seen = {}
    for name, offset_m in (("middle", 0.0), ("under", 0.14), ("above", 0.4)):
        seen = draw(phase="running", view=looked_at(page, offset_m))
        is_seen[name] = [seen["hasArrow"], "instruction" in seen["clear"]]
    assert is_seen == {"middle": [False, False], "under": [False, True], "above": [True, False]}
    assert draw(phase="idle", view=looked_at(page, 0.14))["clear"] == []


NOSE = (0.95, 84.89, -36.69)
NOT_GUIDED = TraceGuidance()
GUIDED = TraceGuidance(10.0, SkinPlace(NOSE, (0.0, 1.0, 0.0)))
TRACE = """() => {
  const { marks, ring } = page.trace;
  const model = page.stage.model;
  const paint = model.skinMesh.geometry.getAttribute("color");
  const skin = model.skinColor.toArray();
  const isPainted = model.skin.vertexColors;
  let painted = 0;
  for (let i = 0; isPainted && i < paint.count; i++) {
    painted += Math.abs(paint.getX(i) - skin[0]) > 0.1;
  }
  return {
    marks: marks.visible ? marks.count : 0,
    ring: ring.visible ? ring.position.toArray() : null,
    painted,
    color: model.skin.color.toArray(),
  };
}"""


def take_trace(known, points, guidance=NOT_GUIDED):
    """Return the script by which the page takes a trace from the simulator."""
    news = TraceNews(known, tuple(points), guidance.covered_mm, guidance.next_place)
    return f"page.take({message_text(news)})"


def test_a_trace_is_marked_painted_and_undone(page):
    page.evaluate(take_trace(0, [[x, 84.9, -36.7] for x in range(-3, 4)], GUIDED))
    wait_for(page, "page.trace.ring.visible")
    drawn = page.evaluate(TRACE)
    assert drawn["marks"] == 7
    assert drawn["painted"] > 20
    assert drawn["ring"] == pytest.approx([0.00095, 0.08789, -0.03669], abs=1e-6)
    page.evaluate(take_trace(7, [[10.0, 84.0, -30.0]], GUIDED))
    wait_for(page, "page.trace.marks.count === 8")
    assert page.evaluate(TRACE)["painted"] > drawn["painted"]
    page.evaluate(take_trace(2, []))
    wait_for(page, "page.trace.marks.count === 2")
    left = page.evaluate(TRACE)
    assert (left["painted"], left["ring"]) == (0, None)
    assert left["color"] == pytest.approx(page.evaluate("page.stage.model.skinColor.toArray()"))


def test_a_page_that_rejoins_forgets_what_it_knew(page):
    page.evaluate(take_trace(0, [list(NOSE)], GUIDED))
    wait_for(page, "page.trace.marks.count === 1")
    page.evaluate("page.connection.rejoin(page.connection.hello)")
    wait_for(page, "page.trace.marks.count === 0")
    assert not page.evaluate("page.trace.ring.visible")


RULER = DepthRuler(30.0, 37.0, 44.5, 126.0, ("Entry", "Outer table", "Inner table", "Target"))
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
    flatPanel: !document.getElementById("guiding").hidden,
    wornPanel: page.headset?.panels.guiding.mesh.visible ?? false,
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
AIM = {
    "entryMm": [12.0, -3.0],
    "targetMm": [4.0, 7.0],
    "entryDistanceMm": 12.37,
    "angleDeg": 6.48,
}


def at(tool, feed_mm=0.0, aim=None):
    return {"name": "biopsy", "tool": tool, "feedMm": feed_mm, "aim": aim}


def test_the_page_shows_each_tool_with_its_panel_and_the_headset_on_a_board(served, page):
    served.tell(Screen())
    wait_for(page, "page.stage.model !== null && page.state !== null")
    assert page.evaluate(SEEN, at("pointer"))["tools"] == []
    served.tell(Screen(is_head_clear=True, language="de"))
    wait_for(page, "page.screen.isHeadClear")
    seen = page.evaluate(SEEN, at("guide", aim=AIM))
    assert seen["tools"] == ["guide", "axis"]
    assert seen["noGo"] == ["no_go_right-ventricle", "no_go_sagittal-sinus"]
    assert seen["isSeenThrough"]
    assert seen["skin"] < 0.5
    assert seen["flatPanel"]
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
    assert written[-4:] == ["30 Entry", "37 Outer table", "45 Inner table", "126 Target"]
    served.presenter.screen = Screen(is_head_clear=True, ruler=RULER)
    enter_headset(page)
    worn = page.evaluate(SEEN, at("drill", 41.5))
    assert worn["wornPanel"]
    assert not page.evaluate(SEEN, at("pointer"))["tools"]
