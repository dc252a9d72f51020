"""In which order fiducials are touched: one smooth way over the skin, or back and forth."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.complexity import ANGLE_UNIT_DEG, LENGTH_UNIT_MM, angles_deg, turning_deg


@dataclass(frozen=True)
class Ways:
    """What it costs to go from fiducial to fiducial, in the units of the complexity index.

    Attributes:
        steps: (n, n) float: length over the skin and re-orientation of the tool.
        turns: (n, n, n) float: turning at the second of three.
    """

    steps: np.ndarray
    turns: np.ndarray

    def cost(self, order: list[int]) -> float:
        """Return the cost of an order."""
        row = np.array(order)
        turns = self.turns[row[:-2], row[1:-1], row[2:]].sum()
        return float(self.steps[row[:-1], row[1:]].sum() + turns)


def ways_between(points: np.ndarray, normals: np.ndarray, lengths_mm: np.ndarray) -> Ways:
    """Return the ways between points; shapes (n, 3), (n, 3) and (n, n)."""
    count = len(points)
    first, second = np.repeat(np.arange(count), count), np.tile(np.arange(count), count)
    turned = angles_deg(normals[first], normals[second]).reshape(count, count)
    steps = lengths_mm / LENGTH_UNIT_MM + turned / ANGLE_UNIT_DEG
    turns = np.zeros((count,) * 3)
    for a, b, c in np.ndindex(turns.shape):
        if len({a, b, c}) == 3:
            turns[a, b, c] = turning_deg(points[[a, b, c]], normals[[a, b, c]]) / ANGLE_UNIT_DEG
    return Ways(steps, turns)


def easiest_order(ways: Ways, members: list[int]) -> list[int]:
    """Return an order of the members that is cheap: the best of all greedy ways, improved."""
    candidates = [_improved(ways, _greedy(ways, members, start)) for start in members]
    return min(candidates, key=ways.cost)


def crossing_order(ways: Ways, sides: list[list[int]], crossings: int) -> list[int]:
    """Return an order that changes between two sides so many times.

    Each side is gone over in its own easiest order, in runs of equal length.
    """
    runs: list[list[list[int]]] = []
    for side, members in enumerate(sides):
        count = (crossings + 2 - side) // 2
        order = easiest_order(ways, members)
        runs.append([part.tolist() for part in np.array_split(order, count)])
    second_turned = [part[::-1] for part in runs[1][::-1]]
    orders = [_interleaved(runs[0], second) for second in (runs[1], second_turned)]
    return min(orders, key=ways.cost)


def _interleaved(first: list[list[int]], second: list[list[int]]) -> list[int]:
    order: list[int] = []
    for index, run in enumerate(first):
        order += run + (second[index] if index < len(second) else [])
    return order


def _greedy(ways: Ways, members: list[int], start: int) -> list[int]:
    order, left = [start], set(members) - {start}
    while left:
        order.append(min(left, key=lambda other: (ways.steps[order[-1], other], other)))
        left.remove(order[-1])
    return order


def _improved(ways: Ways, order: list[int]) -> list[int]:
    """Reverse and move stretches of the order as long as that makes it cheaper."""
    best = ways.cost(order)
    while True:
        cheapest = min(_changed(order), key=ways.cost)
        cost = ways.cost(cheapest)
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
