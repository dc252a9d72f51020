"""The page draws a trace: marks, the paint around them, and a ring where to draw next."""

from __future__ import annotations

import json

import pytest

from rastrainer_simulator.net.views import outgoing
from rastrainer_simulator.net.views.presenter import SkinPlace, TraceGuidance
from rastrainer_simulator.net.views.screen import Screen
from Testing.web.chromium import open_page, wait_for

LEGEND = "Within 10 mm of traced points"
NOSE = (0.95, 84.89, -36.69)
NOT_GUIDED = TraceGuidance()
GUIDED = TraceGuidance(10.0, SkinPlace(NOSE, (0.0, 1.0, 0.0)))
DRAWN = """() => {
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


def told(known, points, guidance=NOT_GUIDED):
    """What the simulator would tell the page, as the page takes it."""
    return f"page.take({json.dumps(json.loads(outgoing.trace(known, points, guidance)))})"


@pytest.fixture
def page(browser, served):
    size = {"width": 960, "height": 600}
    return open_page(browser, served.url, served.code, size=size, draws=False)


def test_what_was_traced_is_marked_painted_and_taken_back(page):
    page.evaluate(told(0, [[x, 84.9, -36.7] for x in range(-3, 4)], GUIDED))
    wait_for(page, "page.trace.ring.visible")
    drawn = page.evaluate(DRAWN)
    assert drawn["marks"] == 7
    assert drawn["painted"] > 20
    assert drawn["ring"] == pytest.approx([0.00095, 0.08789, -0.03669], abs=1e-6)
    page.evaluate(told(7, [[10.0, 84.0, -30.0]], GUIDED))
    wait_for(page, "page.trace.marks.count === 8")
    assert page.evaluate(DRAWN)["painted"] > drawn["painted"]
    page.evaluate(told(2, []))
    wait_for(page, "page.trace.marks.count === 2")
    left = page.evaluate(DRAWN)
    assert (left["painted"], left["ring"]) == (0, None)
    assert left["color"] == pytest.approx(page.evaluate("page.stage.model.skinColor.toArray()"))
    assert page.problems == []


def test_the_legend_is_read_with_a_sample_of_the_paint(page, served):
    served.tell(Screen(status=("Task 1",), coverage=LEGEND))
    page.wait_for_selector("#status .legend")
    assert page.inner_text("#status .legend") == LEGEND
    sample = page.locator("#status .legend i")
    assert sample.evaluate("e => getComputedStyle(e).backgroundColor") == "rgb(87, 181, 232)"
    served.tell(Screen(status=("Task 1",)))
    wait_for(page, "document.querySelector('#status .legend') === null")


def test_a_page_that_joins_again_forgets_what_it_knew(page):
    page.evaluate(told(0, [list(NOSE)], GUIDED))
    wait_for(page, "page.trace.marks.count === 1")
    page.evaluate("page.connection.rejoin({ kind: 'page', device: '', refreshHz: 0 })")
    wait_for(page, "page.trace.marks.count === 0")
    assert not page.evaluate("page.trace.ring.visible")
