"""What the page draws of a state: how a touch is going, and the ghost beside the arm."""

from __future__ import annotations

import pytest

from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.net.views.screen import Screen
from rastrainer_simulator.state import TOUCH_ERRORS, TouchStage
from Testing.simulator.flow.conftest import put_back
from Testing.simulator.net.views.served import ServedViews
from Testing.web.chromium import open_page
from Testing.web.place import PATIENT

RED = 0xC7001A
DRAW = """
(changes) => {
  const state = { ...page.state, ...changes };
  page.isDue = true;
  page.ghost.put(state.time, state.ghost, 1);
  page.drawFlat(page.flat, 1, page.stage.model, state);
  return {
    ring: page.ring.mesh.visible ? page.ring.mesh.scale.x : 0,
    color: page.ring.material.color.getHex(),
    tip: page.stage.model.tip.color.getHex(),
    isFramed: !document.getElementById("contact").hidden,
    ghost: page.ghost.doubles.map((double) => double.position.toArray()),
  };
}
"""


@pytest.fixture(scope="module")
def draw(browser, shared, loop_thread, tmp_path_factory):
    """Return a function that draws a state with some changes and returns what is seen of it."""
    put_back(shared)
    with ControlLoop(shared, tmp_path_factory.mktemp("records")) as loop:
        served = ServedViews(loop_thread, loop, **PATIENT)
        page = open_page(browser, served.url, served.code, draws=False)
        served.tell(Screen(status=("Task 1",)))
        page.wait_for_selector("#status:has-text('Task 1')")
        yield lambda **changes: page.evaluate(DRAW, changes)
        assert page.problems == []
        page.context.close()
        served.close()


def test_tip_ring_and_frame_are_red_only_where_a_touch_goes_wrong(draw):
    for stage in TouchStage:
        seen = draw(touch=stage.value, clearanceMm=0.0)
        is_wrong = stage in TOUCH_ERRORS
        assert seen["isFramed"] is is_wrong
        assert (seen["tip"] == RED) is is_wrong
        assert (seen["ring"] > 0) is (stage is not TouchStage.FAR)
        if seen["ring"]:
            assert (seen["color"] == RED) is is_wrong


def test_the_ring_closes_as_the_tip_comes_nearer(draw):
    radii = [draw(touch="near", clearanceMm=clearance)["ring"] for clearance in (20.0, 10.0, 0.0)]
    assert radii == pytest.approx([0.025, 0.015, 0.005])


def test_a_ghost_is_where_the_stream_says_and_goes_when_it_ends(draw):
    assert draw()["ghost"] == []
    poses = {"link_7": [0.4, 0.1, 0.7, 0, 0, 0, 1], "tool": [0.4, 0.1, 0.5, 0, 0, 0, 1]}
    assert draw(ghost=poses)["ghost"] == [pytest.approx(pose[:3]) for pose in poses.values()]
    assert draw()["ghost"] == []
