"""Find the order in which fiducials are touched: one smooth path, or back and forth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.scenario.complexity import ANGLE_UNIT_DEG, LENGTH_UNIT_MM, angles_deg, turns_deg


@dataclass(frozen=True)
class Transitions:
    """The costs of moving from fiducial to fiducial, in the units of the complexity index.

    Attributes:
        steps: (n, n) float: length over the skin and reorientation of the tool.
        turns: (n, n, n) float: turning at the second of three.
    """

    steps: np.ndarray
    turns: np.ndarray

    def costs(self, orders: list[list[int]]) -> np.ndarray:
        """Return the costs (m,) of m orders of as many fiducials each."""
        rows = np.array(orders)
        steps = self.steps[rows[:, :-1], rows[:, 1:]].sum(axis=1)
        return steps + self.turns[rows[:, :-2], rows[:, 1:-1], rows[:, 2:]].sum(axis=1)

    def easiest(self, orders: list[list[int]]) -> tuple[float, list[int]]:
        """Return the least cost and the first order that has it."""
        costs = self.costs(orders)
        best = int(np.argmin(costs))
        return float(costs[best]), orders[best]


def transitions_between(
    points: np.ndarray, normals: np.ndarray, lengths_mm: np.ndarray
) -> Transitions:
    """Return the transitions between points; shapes (n, 3), (n, 3) and (n, n)."""
    count = len(points)
    first, second = np.indices((count, count)).reshape(2, -1)
    turned = angles_deg(normals[first], normals[second]).reshape(count, count)
    before, at, after = np.indices((count,) * 3).reshape(3, -1)
    turns = turns_deg(points[before], points[at], points[after], normals[at])
    return Transitions(
        lengths_mm / LENGTH_UNIT_MM + turned / ANGLE_UNIT_DEG,
        turns.reshape((count,) * 3) / ANGLE_UNIT_DEG,
    )


def arc_lengths(points: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """Estimate the lengths of the paths over the skin between points (n, 3); (n, n) mm.

    The skin between two points is assumed to bend evenly, by the angle between their normals: good
    enough for ordering fiducials, and thousands of times faster than paths over the surface.
    """
    chords = np.linalg.norm(points[:, None] - points[None], axis=2)
    half = np.arccos(np.clip(normals @ normals.T, -1.0, 1.0)) / 2.0
    return chords / np.sinc(half / np.pi)


def easiest_order(transitions: Transitions, members: list[int]) -> list[int]:
    """Return a cheap order of the members: the best of all greedy orders, improved."""
    orders = [_improved(transitions, _greedy(transitions, members, start)) for start in members]
    return transitions.easiest(orders)[1]


def crossing_order(transitions: Transitions, sides: list[list[int]], crossings: int) -> list[int]:
    """Return an order with a number of crossings between two sides.

    Each side is touched in its own easiest order, in runs of equal length.
    """
    runs: list[list[list[int]]] = []
    for side, members in enumerate(sides):
        count = (crossings + 2 - side) // 2
        order = easiest_order(transitions, members)
        runs.append([part.tolist() for part in np.array_split(order, count)])
    second_turned = [part[::-1] for part in runs[1][::-1]]
    return transitions.easiest(
        [_interleaved(runs[0], second) for second in (runs[1], second_turned)]
    )[1]


def _interleaved(first: list[list[int]], second: list[list[int]]) -> list[int]:
    order: list[int] = []
    for index, run in enumerate(first):
        order += run + (second[index] if index < len(second) else [])
    return order


def _greedy(transitions: Transitions, members: list[int], start: int) -> list[int]:
    order, left = [start], set(members) - {start}
    while left:
        order.append(min(left, key=lambda other: (transitions.steps[order[-1], other], other)))
        left.remove(order[-1])
    return order


def _improved(transitions: Transitions, order: list[int]) -> list[int]:
    """Reverse and move stretches of the order while that makes it cheaper."""
    best = np.inf
    while True:
        cost, cheapest = transitions.easiest(_changed(order))
        if cost >= best - 1e-9:
            return order
        order, best = cheapest, cost


def _changed(order: list[int]) -> list[list[int]]:
    count = len(order)
    changed = [order]
    for start in range(count):
        for end in range(start + 1, count + 1):
            stretch, rest = order[start:end], order[:start] + order[end:]
            changed.append(order[:start] + stretch[::-1] + order[end:])
            if len(stretch) <= 3:
                changed += [rest[:at] + stretch + rest[at:] for at in range(len(rest) + 1)]
    return changed
