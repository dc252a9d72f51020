"""A trainee who carries out a procedure by what every view draws, and by input devices alone."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from rastrainer_simulator.presentation.screen import DepthRuler, ErrorArrow, Tone
from Testing.end_to_end.stream_trainee import Hands, StreamTrainee

ALIGNED_MM, ALIGNED_DEG = 0.8, 0.8
"""The accuracy to which a hand brings the guide."""
BEFORE_ENTRY_M = 0.03
FAR_M = 0.02
FULL_TURN_DEG = 8.0
"""Angle from which the stick is pushed fully to turn the guide."""
LEAST_TURN = 0.45
LONGEST_ALIGNMENT_S = 120.0


class ProcedureHands(Hands, Protocol):
    """Hands that also turn the guide."""

    def turn(self, right: float, up: float, fine: bool) -> None:
        """Push the stick that turns the tool, −1…1."""


class ProcedureTrainee(StreamTrainee):
    """Knows of the plan only the lines that are drawn, the bull's-eye and the ruler."""

    hands: ProcedureHands

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
        (entry,) = (np.array(arrow.end) for arrow in green if _is_ball(arrow))
        (target,) = (np.array(arrow.end) for arrow in green if not _is_ball(arrow))
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


def _is_ball(arrow: ErrorArrow) -> bool:
    return arrow.begin == arrow.end
