"""Spread a joint motion over as many ticks as the joints' speeds need."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class LimitedStep(NamedTuple):
    """Joint angles (rad) for this tick, and whether the goal had to wait."""

    q: tuple[float, ...]
    limited: bool


def limit_step(
    q: Sequence[float], goal: Sequence[float], velocity: Sequence[float], dt: float
) -> LimitedStep:
    """Return the step from `q` toward `goal` (rad) within `velocity` (rad/s) for a tick of `dt` s.

    All joints are slowed alike, so they arrive together and each keeps between its start and goal.
    """
    steps = [b - a for a, b in zip(q, goal, strict=True)]
    slowest = max([abs(step) / (speed * dt) for step, speed in zip(steps, velocity, strict=True)])
    if slowest <= 1.0:
        return LimitedStep(tuple(goal), False)
    return LimitedStep(tuple([a + step / slowest for a, step in zip(q, steps, strict=True)]), True)
