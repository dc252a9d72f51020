"""A model trainee that sees no picture: it only reads the screen, and steers by its words."""

from __future__ import annotations

import math
import re

import numpy as np

from rastrainer.protocol import Phase
from rastrainer_simulator.net.views.screen import Tone
from Testing.simulator.flow.trainee import STEP_S, Trainee
from Testing.simulator.virtual.trained_pad import TrainedPad

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
UP = np.array(WAYS["up"])
GAIN_PER_S, LEAST_M_S = 2.0, 0.006
"""How fast a point is approached that the words tell."""
ASIDE_M_S, ASIDE_READS = 0.03, 3
GOLDEN_ANGLE = math.pi * (3.0 - math.sqrt(5.0))
LOWERED_MM = 30.0
"""Farther than this beside the point the tip is not lowered."""
BETTER_READS = 25
"""So often the words are followed on the skin for a nearer place, before Touch is pressed."""
DOWN_M_S, EASE_M_S, OFF_M_S, CARRY_M_S, CENTER_M_S = 0.06, 0.01, 0.08, 0.1, 0.015
FIRST_M, SPACING_M, WIDEST_M = 0.012, 0.011, 0.09
"""Radii of the spiral, and its places' distances: a touch counts within 10 mm of the point."""
SUNK_M, LIFT_M = 0.045, 0.012
"""How far the tip is lowered before it must be beside the head, and how far it is lifted."""
CENTER_READS, CARRY_READS, EASE_READS = 80, 100, 12


class ReadingTrainee:
    """Touches the fiducials of the trial that runs by what it reads: "Point 9: 15 mm back, down".

    Where that is not told, it lowers the tip at places on a spiral around its last touch, and turns
    back where it reads that it is off the path. Where it reads "On the skin", it goes to the middle
    of the places where that is said, and presses Touch. It keeps count of its own movements.

    Args:
        trainee: at the presenter, with a `TrainedPad`.
        pad: its gamepad.
    """

    def __init__(self, trainee: Trainee, pad: TrainedPad) -> None:
        self._trainee = trainee
        self._pad = pad
        self._limit_s = 0.0
        self._moved = np.zeros(3)
        self._radius, self._angle, self._turn = FIRST_M, 0.0, 1.0
        self._is_off = False
        self._has_met_head = False

    def play(self, limit_s: float) -> None:
        """Go on until all points are touched, or until the trial has lasted so long."""
        self._limit_s = limit_s
        while self._goes_on:
            told = self._told()
            if told is not None:
                self._follow(*told)
            elif self._is_on_skin:
                self._center()
                if self._is_on_skin:
                    self._press()
            else:
                self._search()
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
    def _is_refused(self) -> bool:
        """Whether the last touch was: that is read until the next, also on the skin."""
        text = self._instruction
        return text.startswith(("Too far", "Wrong point")) or "above the skin" in text

    @property
    def _warnings(self) -> str:
        """What is wrong with where the arm is; "" where nothing is."""
        warnings = self._trainee.presenter.screen.warnings
        return " ".join(warning.text for warning in warnings if warning.tone is not Tone.PLAIN)

    def _told(self) -> tuple[float, tuple[str, ...]] | None:
        """Return how far the next point is, mm, and which ways; None where that is not told."""
        for text in self._trainee.presenter.screen.status:
            found = re.match(r"Point \d+: ([\d.]+) mm (.*)", text)
            if found is not None:
                return float(found[1]), tuple(found[2].split(", "))
        return None

    def _move(self, velocity: np.ndarray) -> None:
        """Move for a moment: (3,) float, m/s."""
        self._pad.move(velocity)
        self._trainee.step(READ_STEPS)
        self._moved += velocity * READ_STEPS * STEP_S

    def _follow(self, away_mm: float, ways: tuple[str, ...]) -> None:
        """Go the ways that are told; on the skin press Touch where no nearer place is told."""
        # Where the words end, the search begins.
        self._moved[:] = 0.0
        self._radius = FIRST_M
        reads = 0
        while self._is_on_skin and away_mm > 0.0 and reads < BETTER_READS:
            self._move(CENTER_M_S * _way(ways))
            away_mm, ways = self._told() or (0.0, ())
            reads += 1
        if self._is_on_skin or (self._is_refused and not self._warnings and away_mm == 0.0):
            self._press()
        elif self._warnings:
            self._step_aside(ways)
        else:
            level = _level(ways)
            if away_mm > LOWERED_MM and level:
                ways = tuple(way for way in ways if way != "down")
            self._move(max(LEAST_M_S, GAIN_PER_S * away_mm / 1000.0) * _way(ways))

    def _step_aside(self, ways: tuple[str, ...]) -> None:
        """Lift the tip off what it touches, and go aside: as is told, or any way."""
        self._angle += GOLDEN_ANGLE
        any_way = np.array([math.cos(self._angle), math.sin(self._angle), 0.0])
        level = _level(ways)
        for velocity in (OFF_M_S * UP, ASIDE_M_S * (_way(level) if level else any_way)):
            for _ in range(ASIDE_READS):
                self._move(velocity)

    def _to_skin(self) -> np.ndarray:
        """Return a velocity, (3,) m/s, that brings the tip back onto the skin."""
        warnings = self._warnings
        if self._is_on_skin or warnings.startswith("The tip is on the skin"):
            return 0.0 * UP
        return CENTER_M_S * UP if warnings else -CENTER_M_S * UP

    def _search(self) -> None:
        """Lower the tip onto the skin at the next place of the spiral, and lift it again.

        Where it reads there that it is off the path, it turns back.
        """
        self._angle += self._turn * SPACING_M / self._radius
        self._radius += SPACING_M**2 / (2.0 * math.pi * self._radius)
        if self._radius > WIDEST_M:
            self._radius = FIRST_M
        self._carry(self._radius * np.array([math.cos(self._angle), math.sin(self._angle)]))
        is_off = "off the path" in self._instruction
        if is_off and not self._is_off:
            self._turn *= -1.0
            self._radius += SPACING_M
        self._is_off = is_off
        if not is_off:
            self._peck()

    def _carry(self, place: np.ndarray) -> None:
        """Carry the tip over a place, (2,) float, m, as its movements are counted."""
        for _ in range(CARRY_READS):
            away = np.array([*(place - self._moved[:2]), 0.0])
            distance = float(np.linalg.norm(away))
            if not self._goes_on or distance < 0.002:
                break
            speed = min(CARRY_M_S, distance / (READ_STEPS * STEP_S))
            self._move(OFF_M_S * UP if self._warnings else speed * _unit(away))

    def _peck(self) -> None:
        """Lower the tip until a warning says what it touches; lift it unless a touch counts."""
        top = self._moved[2]
        while self._goes_on and not self._warnings and not self._is_on_skin:
            if top - self._moved[2] > SUNK_M and self._has_met_head:
                break
            self._move(-DOWN_M_S * UP)
        for _ in range(EASE_READS):
            if not self._warnings.startswith("Pressing"):
                break
            self._move(EASE_M_S * UP)
        if self._is_refused and self._has_met_head and not self._warnings:
            self._press()
        if self._is_on_skin:
            return
        is_met = bool(self._warnings)
        self._has_met_head |= is_met
        height = LIFT_M if is_met else top - self._moved[2]
        for _ in range(math.ceil(height / (OFF_M_S * READ_STEPS * STEP_S))):
            self._move(OFF_M_S * UP)

    def _center(self) -> None:
        """Go to the middle of where the touch counts, along one way and then across it."""
        for way in (np.array(WAYS["right"]), np.array(WAYS["forward"])):
            self._cross(way)
            reads = self._cross(-way)
            self._cross(way, reads // 2)

    def _cross(self, way: np.ndarray, most: int = CENTER_READS) -> int:
        """Go one way over where a touch counts; return how often it read that it does."""
        reads = 0
        for _ in range(CENTER_READS):
            is_past = reads > 0 and self._warnings.startswith("The tip is on the skin")
            if not self._goes_on or is_past or reads >= most:
                break
            reads += self._is_on_skin
            self._move(CENTER_M_S * way + self._to_skin())
        return reads

    def _press(self) -> None:
        """Press Touch; where the touch counts, lift the tip and search anew from there."""
        trainee = self._trainee
        self._pad.stop()

        def answers() -> tuple[int, int]:
            training = trainee.state.training
            return len(training.touches), training.rejected

        before = answers()
        trainee.tap("touch")
        trainee.until(lambda: answers() != before, "an answer")
        if answers()[0] > before[0]:
            self._moved[:] = 0.0
            self._radius = FIRST_M
            for _ in range(5):
                self._move(OFF_M_S * UP)


def _level(ways: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(way for way in ways if way not in ("up", "down"))


def _way(ways: tuple[str, ...]) -> np.ndarray:
    return _unit(np.sum([WAYS[way] for way in ways], axis=0))


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / max(1e-9, float(np.linalg.norm(vector)))
