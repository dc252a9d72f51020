"""A registration by surface from the menu to the result, by a gamepad and by a headset alone.

The trainee draws where the ring is. The simulator registers the trace and scores it itself.
"""

from __future__ import annotations

import re

import numpy as np
import pytest

from rastrainer.number_text import with_units
from rastrainer.protocol import MIN_TRACE_POINTS, RegistrationMethod
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.analysis import TrialAnalysis
from rastrainer_simulator.presentation.screen import Menu
from Testing.end_to_end.faulty_proxy import SlicerSide
from Testing.end_to_end.hands import Controllers, GamepadHands
from Testing.end_to_end.lab import Lab, Place
from Testing.end_to_end.stream_trainee import LEAST_FINE_PUSH, LIFT_M, SINK_M, Trainee
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.landmarked import LANDMARKS, write_landmarked
from Testing.web.chromium import enter_headset, open_page
from Testing.web.trainees_on_page import SLOW, XR

# Drawing takes minutes, in a headset many.
pytestmark = pytest.mark.soak

METHOD = "trace over the skin"
"""As the experiment menu calls it."""
POINTS = 70
CENTER_M = np.array([0.001, -0.012, 0.016])
"""In the head's RAS frame."""
COARSE = LANDMARKS[:3]
SEEN_OFF_MM = 0.3
"""Height above the skin at which the tip has visibly left it."""
TURN_BACK_M = 0.006
STROKE_POINTS = 12
TRACING = "over parts that face different ways"
"""Shown during a stroke."""
DRAWN = """() => {
  const { marks, ring } = page.trace;
  return [marks.count, ring.visible, page.stage.model.skin.vertexColors];
}"""


class DrawingTrainee(Trainee):
    """Knows the landmarks of the head by sight, and of the trace what all views receive."""

    @property
    def touched(self) -> int:
        """How many landmarks are touched, as the screen says."""
        said = " ".join(self.view.screen.status)
        found = re.search(r"(\d+) of 3 points", said)
        if found is None:
            return len(COARSE) if "points traced" in said else 0
        return int(found[1])

    @property
    def traced(self) -> int:
        """How many points are traced, as the screen says."""
        found = re.search(r"(\d+) of 30–500 points", " ".join(self.view.screen.status))
        return int(found[1]) if found else 0

    @property
    def is_drawing(self) -> bool:
        """Whether a stroke is on, as the screen says."""
        return TRACING in self.view.screen.instruction.text

    def place_of(self, label: str) -> np.ndarray:
        """Return where a landmark is, (3,) float, World, m."""
        (place,) = [each.position_ras for each in LANDMARKS if each.name == label]
        return self._in_world(place / MM_PER_M)

    @property
    def head_center(self) -> np.ndarray:
        """(3,) float, World, m."""
        return self._in_world(CENTER_M)

    def begin_task(self, task: str) -> None:
        """Choose a task in the experiment's menu; landmarks are marked in no scene."""
        self.choose(task)
        self.until_menu(None)

    def touch_landmarks(self) -> None:
        """Touch the landmarks that begin a registration by surface."""
        for landmark in COARSE:
            self.until(
                lambda name=landmark.name: name in self.view.screen.instruction.text, landmark.name
            )
            self.approach(landmark.name, 0.02)
            self.press_on(landmark.name)

    def draw_until(self, count: int) -> list[dict]:
        """Draw strokes where the ring is until enough points are traced; return the rings."""
        rings = []
        while self.traced < count:
            self.until(lambda: self.view.trace["next"] is not None, "a ring")
            rings.append(self.view.trace["next"])
            self._draw_at(rings[-1])
        return rings

    def accept_match(self) -> dict[str, str]:
        """Have the trace registered when its match is known; return what the menu says of it."""
        self.press("menu", lambda: self.menu_name == "trial", "the menu")
        self.choose("register")
        self.until_menu("match")
        known: list[Menu] = []

        def is_known() -> bool:
            menu = self.menu
            items = () if menu is None else menu.items
            if any(item.name == "accept" and item.is_enabled for item in items):
                known.append(menu)
            return bool(known)

        self.until(is_known, "the match")
        self.choose("accept")
        self.until_menu("result")
        return {fact.label: fact.value for fact in known[0].facts}

    def _draw_at(self, ring: dict) -> None:
        head = self.view.pose("head")[:3, :3]
        place = self._in_world(np.array(ring["positionMm"]) / MM_PER_M)
        outward = head @ np.array(ring["normal"])
        self.go_above(place, 0.02)
        self.steer_to(place + LIFT_M * outward, 0.008)
        self.steer_to(place + 0.006 * outward, 0.004)
        self.sink_onto_skin(place - SINK_M * outward)
        self.hands.push(0.0, 0.0, 0.0, False)
        self.until_still()
        self.press("touch", lambda: self.is_drawing, "a stroke")
        self._draw_about(place, outward)
        self.hands.push(0.0, 0.0, 0.0, False)
        self.press("touch", lambda: not self.is_drawing, "the end of a stroke")
        self.steer_to(place + LIFT_M * outward, 0.01)

    def _draw_about(self, place: np.ndarray, outward: np.ndarray) -> None:
        """Draw back and forth across a place, on the skin as far as the visible height shows."""
        along = np.cross(outward, (0.0, 0.0, 1.0))
        along /= np.linalg.norm(along)
        wanted, give_up = self.traced + STROKE_POINTS, self.view.state["timeS"] + 30.0
        while self.traced < wanted and self.view.state["timeS"] < give_up:
            away = self.tip - place
            if np.linalg.norm(away) > TURN_BACK_M and away @ along > 0.0:
                along = -along
            heading = along.copy()
            if self.view.state["touch"] == "too deep":
                heading = heading + 0.5 * outward
            elif self.view.state["clearanceMm"] > SEEN_OFF_MM:
                heading = heading - outward
            pushed = LEAST_FINE_PUSH * (self._stick_axes() @ heading) / np.linalg.norm(heading)
            self.hands.push(*pushed.tolist(), True)
            self.view.next_state()

    def _in_world(self, place: np.ndarray) -> np.ndarray:
        head = self.view.pose("head")
        return head[:3, :3] @ place + head[:3, 3]


@pytest.mark.parametrize("device", ["gamepad", XR])
def test_a_trace_drawn_by_hand_is_registered_as_shown_and_scored_as_slicer_does(
    tmp_path, browser, device
):
    options = ("--scenario", str(write_landmarked(tmp_path / "scenario")), "--speed")
    if device == "gamepad":
        with Lab(tmp_path, *options, "2", "--seed", "9", guidance="arrow") as lab:
            traced = draw(lab, GamepadHands(lab.simulator))
            check_registered(lab, traced, device)
        return
    with Place(tmp_path, *options, SLOW, guidance="arrow") as place:
        # No picture is needed: the panels are drawn, and an empty scene.
        page = open_page(browser, place.url, place.code, "metaQuest2", draws=False)
        enter_headset(page)
        traced = draw(place, Controllers(page))
        count, has_ring, is_painted = page.evaluate(DRAWN)
        assert 0 < count <= traced.traced
        assert (has_ring, is_painted) == (True, True)
        check_registered(place, traced, device)
        assert page.problems == []


def draw(place: Place, hands: object) -> DrawingTrainee:
    """Choose the method, touch landmarks, and draw where the rings are."""
    trainee = DrawingTrainee(place.view, hands)
    trainee.go_to_experiment()
    trainee.type_id(None)
    trainee.set_choice("method", METHOD)
    trainee.begin_task("task-1")
    trainee.touch_landmarks()
    rings = trainee.draw_until(POINTS)
    places = np.array([ring["positionMm"] for ring in rings])
    assert len(places) >= POINTS // 20
    assert np.linalg.norm(np.diff(places, axis=0), axis=1).min() > 10.0
    return trainee


def check_registered(place: Place, trainee: DrawingTrainee, device: str) -> None:
    """Accept the match, and compare the screen, the records and Slicer's results."""
    shown = trainee.accept_match()
    result = {fact.label: fact.value for fact in trainee.menu.facts}
    (registration,), (scored,) = place.entries("registration"), place.entries("scored")
    registered, slicers = registration["arguments"], scored_by_slicer(place)
    assert place.operators == {device}
    assert [entry["label"] for entry in place.entries("touch")] == [each.name for each in COARSE]
    count = len(place.entries("trace"))
    assert count >= POINTS > MIN_TRACE_POINTS
    assert shown["Residual"] == with_units(f"{registered['freMm']:.2f} mm")
    expected = with_units(f"{registered['expectedTreMm']:.2f} mm")
    assert shown["Expected error at the target (TRE)"] == expected
    assert registered["freMm"] < 1.0
    assert registered["expectedTreMm"] < 3.0
    assert float(result["True error at the target (TRE)"].removesuffix("mm")) < 5.0
    assert registered["matrix"] == slicers.rigid.matrix.ravel().tolist()
    assert registered["freMm"] == slicers.rigid.fre_mm
    assert scored["arguments"]["score"] == slicers.score.score
    assert slicers.record.method is RegistrationMethod.SURFACE
    assert len(slicers.record.trace) == count


def scored_by_slicer(place: Place) -> TrialAnalysis:
    """Have Slicer's side, which comes later, store the trial, register it and score it."""
    folder, scored = place.records.parent, []
    scenario = load_scenario(folder / "scenario")
    find = lambda _name: scenario  # noqa: E731
    study, port = folder / "slicers.db", place.simulator.port
    slicer = SlicerSide(study, port, TrialLogic, find, place.records)
    slicer.logic.trialScored.connect(scored.append)
    wait_until(lambda: slicer.run_for(10) or scored, "Slicer's score")
    slicer.close()
    return scored[0]
