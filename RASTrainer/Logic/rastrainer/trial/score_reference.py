"""What the score of a task is measured against, from the scenario itself.

The same hands are to get the same score on every task of every head: the time that a task may take
comes from the way of the tip through its fiducials, and the error that it may leave from how errors
along the skin at the fiducials reach the region. A touch is on the skin, so its errors are along
it; errors alike in all directions (Fitzpatrick, West and Maurer 1998) would allow tasks on a small
patch up to twice of what the same hands leave there. docs/error-rates.md shows how equal the scores
are on three heads.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario.fiducial_normals import fiducial_normals
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.brain_region import region_of
from rastrainer.trial.scoring import ScoreReference

LIFT_MM = 35.0
"""How far the tip is off the skin on its way from one fiducial to the next."""
TOUCH_S, SPEED_MM_S = 5.2, 26.0
"""What a fiducial takes, and how fast the tip travels between two. The proportion is that of the
virtual trainee on the six tasks of Colin27; the size makes the mean of Tasks 1 to 5 the 127 s of
the published study, pooled over both modes."""
PUBLISHED_RMSE_MM = 1.4
"""The published study's mean RMSE over fifteen fiducials."""
REFERENCE_FLE_MM = PUBLISHED_RMSE_MM / np.sqrt(1 - 2 / FIDUCIAL_COUNT)
"""The FLE that explains it: E[FRE²] = (1 − 2/N) E[FLE²]."""


def score_reference(
    scenario: Scenario, task_name: str, of_protocol: Mapping[str, ScoreReference] | None = None
) -> ScoreReference:
    """Return the reference of a task.

    Args:
        scenario: with the task.
        task_name: of the task.
        of_protocol: references by task that a study's protocol sets; they come first.

    Raises:
        InputError: there is no such task, or the head's mesh cannot be used.
    """
    if of_protocol and task_name in of_protocol:
        return of_protocol[task_name]
    fiducials = np.asarray(scenario.task(task_name).fiducials, dtype=float)
    normals = fiducial_normals(scenario, task_name)
    return ScoreReference(
        time_s=_time_s(fiducials, normals),
        tre_mm=float(REFERENCE_FLE_MM * region_of(scenario).tre_per_fle(fiducials, normals)),
    )


def _time_s(fiducials: np.ndarray, normals: np.ndarray) -> float:
    """Return the time of fiducials (n, 3) with the skin's outward unit normals (n, 3).

    Between two fiducials the tip goes straight from above the one to above the other: where the
    skin turns between them, and with it the tool, that way is the longer one.
    """
    above = fiducials + LIFT_MM * normals
    way_mm = np.linalg.norm(np.diff(above, axis=0), axis=1).sum()
    return float(TOUCH_S * len(fiducials) + way_mm / SPEED_MM_S)
