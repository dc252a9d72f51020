"""A biopsy from the menu to the result by the controllers of a headset alone.

Slicer's side registers the touches and scores the trial.
"""

from __future__ import annotations

import pytest
from playwright.sync_api import Page

from Testing.end_to_end.procedure_trainee import ALIGNED_DEG, ALIGNED_MM, ProcedureTrainee
from Testing.web.chromium import enter_headset, open_page
from Testing.web.hands import Controllers
from Testing.web.place import WITHOUT_GRAPHICS, Place, Trainee, scored_trial
from Testing.web.test_whole_flow import SLOW, XR

# A headset is drawn twice, by a machine without a graphics processor: many minutes.
pytestmark = pytest.mark.soak

TITLE = "Biopsy of a frontal lesion"
PAST_INNER_MM = 1.0


class TurningControllers(Controllers):
    """Turns and tilts the guide by the right stick, while its trigger is held."""

    def turn(self, right: float, up: float, fine: bool) -> None:  # noqa: ARG002
        """Push the right stick; it turns finely."""
        self._page.evaluate(
            """([x, y]) => {
              device.controllers.right.updateAxes("thumbstick", x, y);
              device.controllers.right.updateButtonValue("trigger", x !== 0 || y !== 0 ? 1 : 0);
            }""",
            [right, -up],
        )


class HeadsetSurgeon(ProcedureTrainee, Trainee):
    """Carries out the procedure by the picture alone, however rare pictures are."""


@pytest.fixture(scope="module")
def operated(tmp_path_factory, browser) -> dict:
    """Carry out the biopsy; return the results."""
    folder = tmp_path_factory.mktemp("operated")
    with Place(folder, "--speed", SLOW, limits=WITHOUT_GRAPHICS) as place:
        url, code = place.simulator.url, place.simulator.code
        # No picture is needed: the panels are drawn, and an empty scene.
        page = open_page(browser, url, code, "metaQuest2", draws=False)
        enter_headset(page)
        surgeon = HeadsetSurgeon(place.view, TurningControllers(page))
        slicer = place.start_slicer()
        begin(surgeon, page)
        surgeon.touch_all()
        surgeon.register()
        surgeon.until(lambda: surgeon.view.state["phase"] == "verifying", "the verification")
        surgeon.until(lambda: "FRE" in surgeon.view.screen.instruction.text, "a registration")
        surgeon.touch("checkpoint")
        surgeon.next_step("accept", "aligning")
        surgeon.align_by_hand()
        seen = {"aligned": surgeon.procedure["aim"]}
        surgeon.next_step("lock", "drilling")
        surgeon.until(lambda: surgeon.view.screen.ruler is not None, "the ruler")
        surgeon.feed_to(surgeon.ruler.inner_mm + PAST_INNER_MM)
        surgeon.next_step("insert", "inserting")
        surgeon.feed_to(surgeon.ruler.target_mm)
        seen["inserted"] = surgeon.procedure["feedMm"], surgeon.ruler.target_mm
        surgeon.next_step("release", "registered")
        seen["results"] = scored_trial(slicer)
        surgeon.until_menu("result")
        seen["labels"] = [fact.label for fact in surgeon.menu.facts]
        seen["operators"] = {entry["operator"] for entry in place.entries("input")} - {""}
        seen["checked"] = place.entries("checkpoint")
        (seen["scored"],) = place.entries("scored")
        seen["problems"] = page.problems
    return seen


def begin(surgeon: HeadsetSurgeon, page: Page) -> None:
    """Choose the biopsy after Task 1, whose fiducials are touched first."""
    surgeon.go_to_experiment()
    surgeon.type_id(page)
    surgeon.focus("procedure")
    while surgeon.value("procedure") != TITLE:
        before = surgeon.value("procedure")
        surgeon.press("right", lambda b=before: surgeon.value("procedure") != b, "another one")
    surgeon.begin_task("task-1")
    surgeon.until(lambda: surgeon.view.state["phase"] == "running", "the trial")


def test_the_whole_procedure_is_carried_out_with_the_controllers_alone(operated):
    assert operated["operators"] == {XR}
    assert operated["problems"] == []


def test_a_checkpoint_is_touched_before_the_registration_is_accepted(operated):
    assert len(operated["checked"]) == 1


def test_the_controllers_bring_the_guide_onto_the_line_with_the_bulls_eye(operated):
    aim = operated["aligned"]
    assert aim["entryDistanceMm"] <= ALIGNED_MM
    assert aim["angleDeg"] <= ALIGNED_DEG


def test_the_ruler_guides_the_needle_to_its_depth(operated):
    depth_mm, target_mm = operated["inserted"]
    assert depth_mm == pytest.approx(target_mm, abs=1.0)


def test_slicers_side_scores_the_touches_and_the_procedure(operated):
    assert operated["results"]["record"]["mode"] == "hmd"
    assert operated["results"]["procedure"]["score"]["score"] > 0.0
    assert operated["labels"][0] == "Score of the procedure"
