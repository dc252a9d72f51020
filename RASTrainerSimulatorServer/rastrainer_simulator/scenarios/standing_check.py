"""Do robot and head stand on the table, wherever the head of a trial stands?"""

from __future__ import annotations

import numpy as np

from rastrainer import transforms
from rastrainer.head_mesh import HeadMesh
from rastrainer.scenario import Scenario

ROBOT_FOOT_MM = 110.0
"""From the middle of the robot's base to its outermost screws, rounded up."""


def check_standing(scenario: Scenario, head: HeadMesh) -> list[str]:
    """Return what does not stand on the table, one sentence each."""
    table, wrong = scenario.furniture, []
    half = table.table_size[:2] / 2.0
    low, high = table.table_center - half, table.table_center + half
    extent = f"The table reaches from {_place(low)} to {_place(high)} mm (x, y, from the robot)"
    if (low > -ROBOT_FOOT_MM).any() or (high < ROBOT_FOOT_MM).any():
        wrong.append(
            f"{extent}: the robot's foot, which needs {ROBOT_FOOT_MM:.0f} mm around its middle, "
            "would not stand on it; move the robot or the table."
        )
    foot = transforms.apply(scenario.head_to_world, head.base)[:2]
    around = table.stand_diameter / 2.0 + scenario.perturbation.translation_mm
    if (foot - around < low).any() or (foot + around > high).any():
        wrong.append(
            f"{extent}: the head's stand at {_place(foot)} mm, which needs {around:.0f} mm around "
            "it in trials, would not be on it; move the head or the table."
        )
    lowest = lowest_in_trials_mm(scenario, head)
    if lowest < 0.0:
        wrong.append(
            f"In a trial the head may come {-lowest:.0f} mm into the table; set it up higher, or "
            "let it be moved and tilted less."
        )
    return wrong


def lowest_in_trials_mm(scenario: Scenario, head: HeadMesh) -> float:
    """Return how high above the table the head's lowest place is in the worst trial, mm."""
    limits = scenario.perturbation
    vertices = transforms.apply(scenario.head_to_world, head.vertices)
    pivot = transforms.apply(scenario.head_to_world, scenario.target_position)
    aside = np.hypot(*(vertices - pivot)[:, :2].T)
    height = vertices[:, 2] - pivot[2]
    # Tilted toward it a place sinks, until it is right below the pivot.
    tilt = np.minimum(np.radians(limits.tilt_deg), np.arctan2(aside, -height))
    sunk = pivot[2] + height * np.cos(tilt) - aside * np.sin(tilt)
    return float(sunk.min() - limits.translation_mm)


def _place(point: np.ndarray) -> str:
    return f"({point[0]:.0f}, {point[1]:.0f})"
