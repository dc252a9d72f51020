"""A biopsy from the menu to the result, by a gamepad alone and by a headset's controllers alone.

Slicer's side registers the touches and scores the trial.
"""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer_simulator.presentation.screen import DepthRuler, Tone
from Testing.end_to_end.hands import Controllers, GamepadHands
from Testing.end_to_end.lab import Lab, Place
from Testing.end_to_end.stream_trainee import Trainee
from Testing.web.chromium import enter_headset, open_page
from Testing.web.trainees_on_page import SLOW, XR

# Fifteen touches and a whole procedure by hand take minutes, in a headset many.
pytestmark = pytest.mark.soak

TITLE = "Biopsy of a frontal lesion"
PAST_INNER_MM = 1.0
D_PAD_FROM = 0.3
ALIGNED_MM, ALIGNED_DEG = 0.8, 0.8
"""The accuracy to which a hand brings the guide."""
BEFORE_ENTRY_M = 0.03
FAR_M = 0.02
FULL_TURN_DEG = 8.0
"""Angle from which the stick is pushed fully to turn the guide."""
LEAST_TURN = 0.45
LONGEST_ALIGNMENT_S = 120.0


class TurningGamepad(GamepadHands):
    """Turns the guide by the right stick to the sides, by the D-pad up and down."""

    def turn(self, right: float, up: float, fine: bool) -> None:
        self._simulator.move(rightx=right, righttrigger=1.0 if fine else 0.0)
        for button, sign in (("dpup", 1.0), ("dpdown", -1.0)):
            self._simulator.press(button, sign * up > D_PAD_FROM)


class TurningControllers(Controllers):
    """Turns and tilts the guide by the right stick, finely while its trigger is held."""

    def turn(self, right: float, up: float, fine: bool) -> None:  # noqa: ARG002
        self._page.evaluate(
            """([x, y]) => {
              device.controllers.right.updateAxes("thumbstick", x, y);
              device.controllers.right.updateButtonValue("trigger", x !== 0 || y !== 0 ? 1 : 0);
            }""",
            [right, -up],
        )


class Surgeon(Trainee):
    """Knows of the plan only the lines that are drawn, the bull's-eye and the ruler."""

    @property
    def procedure(self) -> dict:
        """The procedure's part of the stream."""
        return self.view.state["procedure"]

    @property
    def ruler(self) -> DepthRuler:
        """The scale next to the picture."""
        assert self.view.screen.ruler is not None, "something is fed"
        return self.view.screen.ruler

    @property
    def line(self) -> tuple[np.ndarray, np.ndarray]:
        """Entry and target of the green line, World, m: its ball and its end."""
        green = [arrow for arrow in self.view.screen.errors if arrow.tone is Tone.GOOD]
        (entry,) = (np.array(arrow.end) for arrow in green if arrow.begin == arrow.end)
        (target,) = (np.array(arrow.end) for arrow in green if arrow.begin != arrow.end)
        return entry, target

    def place_of(self, label: str) -> np.ndarray:
        """Return where a fiducial is, the first checkpoint that is drawn, or the planned entry."""
        if label == "entry":
            return self.line[0]
        if label == "checkpoint":
            return np.array(self.view.screen.errors[0].begin)
        return super().place_of(label)

    @property
    def touched(self) -> int:
        """Touches of fiducials, or checkpoints that are drawn green."""
        if self.view.state["phase"] != "verifying":
            return super().touched
        return sum(arrow.tone is Tone.GOOD for arrow in self.view.screen.errors)

    def next_step(self, item: str, phase: str) -> None:
        """Open the phase's menu, and choose what leads to another phase."""
        self.press("undo", lambda: self.menu is not None, "the phase's menu")
        self.until_menu("procedure")
        self.choose(item)
        self.until(lambda: self.view.state["phase"] == phase, phase)

    def align_by_hand(self) -> None:
        """Bring the guide before the entry, turn it along the line, and onto it."""
        self.until(lambda: self._sees_line, "the planned line")
        self.approach("entry", 0.03)
        give_up = self.view.state["timeS"] + LONGEST_ALIGNMENT_S
        while not self._is_aligned:
            assert self.view.state["timeS"] < give_up, f"it was never aligned: {self.procedure}"
            self._turn_along()
            entry, target = self.line
            before = entry - BEFORE_ENTRY_M * (target - entry) / np.linalg.norm(target - entry)
            self.steer_to(before, FAR_M)
            self.steer_to(before, 0.0005, fine=True)
            self.hands.push(0.0, 0.0, 0.0, False)
            self.until_still()

    def feed_to(self, depth_mm: float) -> None:
        """Push the stick down until the ruler shows a depth; slowly at its end."""
        for near_mm, is_fine in ((4.0, False), (0.3, True)):
            self.hands.push(0.0, 0.0, -1.0, is_fine)
            self.until(
                lambda n=near_mm: self.procedure["feedMm"] >= depth_mm - n, f"{depth_mm:.1f} mm"
            )
        self.hands.push(0.0, 0.0, 0.0, False)

    @property
    def _sees_line(self) -> bool:
        is_there = self.procedure["aim"] is not None
        return is_there and self.view.screen.is_head_clear and len(self.view.screen.errors) > 1

    @property
    def _is_aligned(self) -> bool:
        aim = self.procedure["aim"]
        return aim["entryDistanceMm"] <= ALIGNED_MM and aim["angleDeg"] <= ALIGNED_DEG

    def _turn_along(self) -> None:
        """Turn the guide by the second stick until it is parallel to the line."""
        self.hands.push(0.0, 0.0, 0.0, False)
        while self.procedure["aim"]["angleDeg"] > 0.6 * ALIGNED_DEG:
            entry, target = self.line
            wanted = (target - entry) / np.linalg.norm(target - entry)
            axis = self.view.pose("tool")[:3, 2]
            right = self._stick_axes()[0]
            across = right - (right @ axis) * axis
            across /= np.linalg.norm(across)
            off = wanted - axis
            turns = np.degrees([off @ across, off @ np.cross(right, axis)])
            push = np.clip(turns / FULL_TURN_DEG, -1.0, 1.0)
            largest = np.abs(push).max()
            is_fine = self.procedure["aim"]["angleDeg"] < 3.0
            push *= max(1.0, LEAST_TURN / largest)
            self.hands.turn(*push.tolist(), is_fine)
            self.view.next_state()
        self.hands.turn(0.0, 0.0, False)
        self.until_still()


@pytest.mark.parametrize("device", ["gamepad", XR])
def test_a_biopsy_is_carried_out_by_hand_alone_and_scored(tmp_path, browser, device):
    if device == "gamepad":
        with Lab(tmp_path, "--speed", "3", "--seed", "11") as lab:
            operate(lab, TurningGamepad(lab.simulator), device)
        return
    with Place(tmp_path, "--speed", SLOW) as place:
        # No picture is needed: the panels are drawn, and an empty scene.
        page = open_page(browser, place.url, place.code, "metaQuest2", draws=False)
        enter_headset(page)
        operate(place, TurningControllers(page), device)
        assert page.problems == []


def operate(place: Place, hands: object, device: str) -> None:
    surgeon = Surgeon(place.view, hands)
    slicer = place.start_slicer()
    surgeon.go_to_experiment()
    surgeon.type_id(None)
    surgeon.set_choice("procedure", TITLE)
    surgeon.begin_task("task-1")
    surgeon.touch_all()
    surgeon.register()
    surgeon.until(lambda: "FRE" in surgeon.view.screen.instruction.text, "a registration")
    surgeon.touch("checkpoint")
    assert any("mm off" in text for text in surgeon.view.screen.status)
    surgeon.next_step("accept", "aligning")
    surgeon.align_by_hand()
    aim = surgeon.procedure["aim"]
    assert aim["entryDistanceMm"] <= ALIGNED_MM
    assert aim["angleDeg"] <= ALIGNED_DEG
    surgeon.next_step("lock", "drilling")
    surgeon.until(lambda: surgeon.view.screen.ruler is not None, "the ruler")
    surgeon.feed_to(surgeon.ruler.inner_mm + PAST_INNER_MM)
    surgeon.next_step("insert", "inserting")
    surgeon.feed_to(surgeon.ruler.target_mm)
    assert surgeon.procedure["feedMm"] == pytest.approx(surgeon.ruler.target_mm, abs=1.0)
    surgeon.next_step("release", "registered")
    results = slicer.results()
    surgeon.until_menu("result")
    first, second, *_others = surgeon.menu.facts
    assert [first.label, second.label] == ["Score of the procedure", "Target point error (RMS)"]
    scored = results["procedure"]
    assert first.value.startswith(f"{scored['score']['score']:.0f}")
    surgeon.choose("procedure")
    surgeon.until_menu("procedure-errors")
    assert "Target point error" in [fact.label for fact in surgeon.menu.facts]
    surgeon.choose("lines")
    surgeon.until(lambda: len(surgeon.view.screen.errors) == 3, "the lines")
    events = {each["kind"] for each in place.view.events}
    assert {"checkpoint", "bone", "through"} <= events
    assert "blocked" not in events
    details = place.entries("scored")[-1]["arguments"]["details"]
    (line,), (slicers,) = details["procedure"]["trajectories"], scored["trajectories"]
    assert line["angleByHandDeg"] <= ALIGNED_DEG + 0.1
    assert line["radialByHandMm"] <= 3.0
    assert abs(line["depthByHandMm"]) <= 1.5
    assert slicers["targetPointError"]["mm"] == line["targetMm"]
    assert place.operators == {device}
    assert results["record"]["mode"] == ("hmd" if device == XR else "desktop")
