"""A registration by surface from the menu to the result by the controllers of a headset alone.

The trainee draws where the ring is. The simulator registers the trace and scores it itself.
"""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.number_text import with_units
from rastrainer.protocol import MIN_TRACE_POINTS
from rastrainer.trial.scoring import SCORE_VERSION
from Testing.end_to_end.drawing_trainee import METHOD, DrawingTrainee
from Testing.simulator.landmarked import write_landmarked
from Testing.web.chromium import enter_headset, open_page
from Testing.web.hands import Controllers
from Testing.web.place import WITHOUT_GRAPHICS, Place, Trainee
from Testing.web.test_whole_flow import SLOW, XR

# A headset is drawn twice, by a machine without a graphics processor: many minutes.
pytestmark = pytest.mark.soak

POINTS = 70
DRAWN = """() => {
  const { marks, ring } = page.trace;
  return [marks.count, ring.visible, page.stage.model.skin.vertexColors];
}"""


class HeadsetDrawer(DrawingTrainee, Trainee):
    """Draws by what the headset shows, and waits for rare pictures as a trainee does."""


@pytest.fixture(scope="module")
def drawn(tmp_path_factory, browser) -> dict:
    """Touch the landmarks, draw, and register; return the results."""
    folder = tmp_path_factory.mktemp("drawn")
    scenario = write_landmarked(folder / "scenario")
    options = ("--scenario", str(scenario), "--speed", SLOW)
    with Place(folder, *options, limits=WITHOUT_GRAPHICS, guidance="arrow") as place:
        # No picture is needed: the panels are drawn, and an empty scene.
        url, code = place.simulator.url, place.simulator.code
        page = open_page(browser, url, code, "metaQuest2", draws=False)
        enter_headset(page)
        drawer = HeadsetDrawer(place.view, Controllers(page))
        drawer.go_to_experiment()
        drawer.type_id(None)
        drawer.choose_method(METHOD)
        drawer.begin_task("task-1")
        drawer.touch_landmarks()
        seen = {"rings": drawer.draw_until(POINTS), "shown": page.evaluate(DRAWN)}
        seen["match"] = drawer.accept_match()
        seen["operators"] = {entry["operator"] for entry in place.entries("input")} - {""}
        seen["traced"] = place.entries("trace")
        (registered,), (scored,) = place.entries("registration"), place.entries("scored")
        seen["registered"], seen["scored"] = registered["arguments"], scored["arguments"]
        seen["guided"] = [entry["guidance"] for entry in place.entries("guidance")]
        seen["problems"] = page.problems
    return seen


def test_the_trace_is_drawn_with_the_controllers_alone(drawn):
    assert drawn["operators"] == {XR}
    assert len(drawn["traced"]) >= POINTS > MIN_TRACE_POINTS
    assert drawn["problems"] == []


def test_the_headset_shows_the_points_the_paint_and_the_ring(drawn):
    count, has_ring, is_painted = drawn["shown"]
    assert 0 < count <= len(drawn["traced"])
    assert has_ring
    assert is_painted
    assert drawn["guided"] == ["arrow"]


def test_each_ring_leads_to_another_place(drawn):
    places = np.array([ring["positionMm"] for ring in drawn["rings"]])
    assert len(places) >= POINTS // 20
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).min() > 10.0


def test_the_simulator_registers_the_trace_and_scores_it(drawn):
    registered = drawn["registered"]
    assert drawn["match"]["Residual"] == with_units(f"{registered['freMm']:.2f} mm")
    assert registered["freMm"] < 1.0
    assert drawn["scored"]["details"]["scoreVersion"] == SCORE_VERSION
    assert drawn["registered"]["expectedTreMm"] < 3.0
