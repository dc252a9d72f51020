"""A model trainee that sees no picture: it only reads the screen, and steers by its words."""

from __future__ import annotations

import math
import re

import numpy as np

from rastrainer.protocol import Phase
from rastrainer_simulator.presentation.screen import Tone
from Testing.simulator.flow.trainee import Trainee
from Testing.simulator.virtual.candidate_points import CandidatePoints, outward, surface_at
from Testing.simulator.virtual.trained_hands import TrainedPad

READ_STEPS = 6
"""Steps of the simulation between two looks at the words."""
WAYS = {
    "right": (1.0, 0.0, 0.0),
    "left": (-1.0, 0.0, 0.0),
    "forward": (0.0, 1.0, 0.0),
    "back": (0.0, -1.0, 0.0),
    "up": (0.0, 0.0, 1.0),
    "down": (0.0, 0.0, -1.0),
}
CARRY_M_S, SLIDE_M_S, CENTER_M_S, LOWER_M_S, EASE_M_S = 0.1, 0.08, 0.03, 0.06, 0.01
NEARBY_M, ABOVE_M = 0.04, 0.025
"""Up to this distance the tip is led along the skin; farther, it is carried so high above it."""
INWARD = 0.05
"""Share of the speed along the skin with which the tip is held on it."""
STEEPER, FORGET = 0.12, 0.97
"""How much steeper it assumes the skin to be, and how much of that it keeps from read to read."""
SUNK_M = 0.03
"""The tip misses the head if it is this far below the expected skin."""
PRESSED_M = 0.012
"""How often Touch is pressed along the skin: a refusal tells which point is there, if any."""
STUCK_READS, CENTER_READS = 50, 80


class ReadingTrainee:
    """Touches the fiducials of the trial that runs by the texts.

    It knows how large a head is and about where this one is, which ways the sticks move the tip,
    and how it has moved since the start. It keeps the places that agree with all that it has read:
    distances and directions where they are shown, "off the path", and "on the skin away from the
    point". It leads the tip along the skin to the nearest of them, back onto the skin where it has
    left it, and presses Touch on the way to read which point is there; it remembers that. Where it
    reads "On the skin", it goes to the middle of the places where that is said, and touches.

    Args:
        trainee: at the presenter, with a `TrainedPad`.
        pad: its gamepad.
    """

    def __init__(self, trainee: Trainee, pad: TrainedPad) -> None:
        self._trainee = trainee
        self._pad = pad
        self._read_s = READ_STEPS * trainee.step_s
        self._limit_s = 0.0
        self._at = np.array(trainee.tip)
        """Where the tip should be by its movements: World, m. The arm always starts there."""
        self._pressed_at = self._at
        self._tilt = np.zeros(3)
        self._lowered = 0
        self._is_told_of_paths = False
        self._places = CandidatePoints()

    def play(self, limit_s: float) -> None:
        """Continue until all points are touched, or until the trial has lasted so long."""
        self._limit_s = limit_s
        while self._goes_on:
            if self._is_on_skin:
                self._center()
                if self._is_on_skin:
                    self._press()
            else:
                self._approach(self._places.nearest(self._at))
        self._pad.stop()

    @property
    def _goes_on(self) -> bool:
        state = self._trainee.state
        return state.training.phase is Phase.RUNNING and state.elapsed < self._limit_s

    @property
    def _instruction(self) -> str:
        return self._trainee.presenter.screen.instruction.text

    @property
    def _is_on_skin(self) -> bool:
        return self._instruction.startswith("On the skin")

    @property
    def _warnings(self) -> str:
        """The arm's warning; "" if there is none."""
        warnings = self._trainee.presenter.screen.warnings
        return " ".join(warning.text for warning in warnings if warning.tone is not Tone.PLAIN)

    @property
    def _is_away_from_point(self) -> bool:
        return self._warnings.startswith("The tip is on the skin away")

    @property
    def _is_pressing(self) -> bool:
        return self._warnings.startswith("Pressing")

    @property
    def _is_touching(self) -> bool:
        """Whether the words tell that the tip is on the skin."""
        return self._is_on_skin or self._is_away_from_point or self._is_pressing

    def _move(self, velocity: np.ndarray) -> None:
        """Move for a moment, (3,) float, m/s, and note the texts after it."""
        self._pad.move(velocity)
        self._trainee.step(READ_STEPS)
        self._at = np.array(self._trainee.tip)
        if self._is_away_from_point:
            self._places.is_not_at(self._at)
        if "off the path" in self._instruction:
            self._is_told_of_paths = True
            self._places.is_off_path(self._at)
        elif self._is_told_of_paths and not self._instruction.startswith(("On", "Too", "Wrong")):
            self._places.is_on_path(self._at)
        self._read_status()

    def _read_status(self) -> None:
        for text in self._trainee.presenter.screen.status:
            guidance = re.match(r"Point \d+: (less than )?([\d.]+) mm (.*)", text)
            if guidance is not None and guidance[1]:
                self._places.is_within(self._at, float(guidance[2]) / 1000.0)
            elif guidance is not None:
                direction = np.sum([WAYS[word] for word in guidance[3].split(", ")], axis=0)
                self._places.is_away(self._at, float(guidance[2]) / 1000.0, direction)

    def _approach(self, place: np.ndarray) -> None:
        """Bring the tip nearer to a position on the skin, until something else is to be done."""
        above = place + ABOVE_M * outward(place)
        if min(np.linalg.norm(goal - self._at) for goal in (place, above)) > NEARBY_M:
            self._carry(place, above)
        else:
            self._slide(place)

    def _carry(self, place: np.ndarray, goal: np.ndarray) -> None:
        """Carry the tip around the head to above a position, while the point may be there."""
        for _ in range(STUCK_READS):
            if not self._goes_on or self._is_on_skin or not self._places.may_be_at(place):
                return
            if np.linalg.norm(goal - self._at) < NEARBY_M:
                return
            out = outward(self._at)
            height = float((self._at - surface_at(self._at)) @ out)
            along = goal - self._at
            along -= (along @ out) * out
            rise = 0.0 if self._warnings else np.clip(2.0 * (ABOVE_M - height), -0.06, 0.06)
            if self._warnings:
                rise = CARRY_M_S
            self._move(CARRY_M_S * _unit(along) + rise * out)

    def _slide(self, place: np.ndarray) -> None:
        """Lead the tip along the skin to a position, while the point may be there."""
        for _ in range(STUCK_READS):
            if not self._goes_on or self._is_on_skin or not self._places.may_be_at(place):
                return
            if (surface_at(self._at) - self._at) @ outward(self._at) > SUNK_M:
                break
            self._along_skin(place - self._at, SLIDE_M_S)
            self._ask()
        # It does not get there, or misses the head: back above the skin, and to another position.
        self._places.cannot_reach(place)
        while self._goes_on and (surface_at(self._at) - self._at) @ outward(self._at) > 0.0:
            self._move(CARRY_M_S * outward(self._at))

    def _along_skin(self, to: np.ndarray, fastest: float) -> None:
        """Move along the skin for a moment, (3,) float, m; where the tip is not on it, onto it.

        Where it reads that it presses or is off the skin, it takes the skin to be tilted.
        """
        out = _unit(outward(self._at) + self._tilt)
        along = to - (to @ out) * out
        ahead = _unit(along)
        self._tilt = FORGET * self._tilt
        speed = min(fastest, float(np.linalg.norm(along)) / self._read_s)
        if self._is_pressing:
            self._tilt = self._tilt - STEEPER * ahead
            self._move(0.3 * speed * ahead + EASE_M_S * out)
        elif self._is_touching or self._places.is_silent_at(self._at):
            self._lowered = 0
            self._move(speed * (ahead - INWARD * out))
        elif self._warnings:
            # The shaft or the arm: off the skin, and on.
            for _ in range(4):
                self._move(0.08 * out + 0.05 * ahead)
        else:
            if self._lowered == 1:
                self._tilt = self._tilt + STEEPER * ahead
            self._lowered += 1
            lower = -min(LOWER_M_S, 0.01 * 1.5 ** min(self._lowered, 5)) * out
            self._move(lower + (0.3 * speed * ahead if self._lowered < 4 else 0.0))

    def _ask(self) -> None:
        """Press Touch where the tip is, to read which point is there; only now and then."""
        is_near = np.linalg.norm(self._at - self._pressed_at) < PRESSED_M
        if is_near or not self._is_away_from_point or not self._places.needs_answers:
            return
        self._pressed_at = self._at
        self._move(np.zeros(3))
        if self._goes_on and self._is_away_from_point:
            self._press()

    def _center(self) -> None:
        """Go to the middle of where the touch counts, along one direction and then across it."""
        out = outward(self._at)
        first = _unit(np.cross(out, (0.0, 1.0, 0.0)))
        for direction in (first, np.cross(out, first)):
            there = self._along_where_it_counts(direction)
            back = self._along_where_it_counts(-direction)
            if there and back:
                self._creep_to((there[-1] + back[-1]) / 2.0)

    def _along_where_it_counts(self, direction: np.ndarray) -> list[np.ndarray]:
        """Go in one direction along the skin, past where a touch counts; return the positions."""
        places: list[np.ndarray] = []
        for _ in range(CENTER_READS):
            if self._is_on_skin:
                places.append(self._at)
            elif not self._goes_on or (places and self._is_away_from_point):
                break
            self._along_skin(direction, CENTER_M_S)
        return places

    def _creep_to(self, place: np.ndarray) -> None:
        """Go to a position on the skin, until it reads there that a touch counts."""
        for _ in range(CENTER_READS):
            out = outward(place)
            along = place - self._at
            along -= (along @ out) * out
            is_there = np.linalg.norm(along) < 0.0007
            if not self._goes_on or (is_there and self._is_on_skin):
                break
            self._along_skin(0.0 * along if is_there else along, CENTER_M_S)

    def _press(self) -> None:
        """Press Touch and read the answer; where the touch counts, search anew from there."""
        trainee = self._trainee
        self._pad.stop()

        def answers() -> tuple[int, int]:
            training = trainee.state.training
            return len(training.touches), training.rejected

        before = answers()
        trainee.tap("touch")
        trainee.until(lambda: answers() != before, "an answer")
        other = re.match(r"Wrong point: that is point (\d+), ([\d.]+) mm", self._instruction)
        if answers()[0] > before[0]:
            self._places.has_touched(self._at, trainee.state.training.next_point or "")
        elif other is not None:
            self._places.is_of(self._at, other[1], float(other[2]) / 1000.0)
        elif too_far := re.match(r"Too far .*: (more than )?(\d+) mm;", self._instruction):
            away_m = float(too_far[2]) / 1000.0
            self._places.is_refused(self._at, away_m, is_farther=too_far[1] is not None)


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / max(1e-9, math.sqrt(float(vector @ vector)))
