"""A scenario whose head has landmarks, for trials that are registered without fiducials."""

from dataclasses import replace

import numpy as np

from rastrainer.scenario.landmarks import Landmark

LANDMARKS = (
    Landmark("Nasion", np.array([2.0, 96.0, -8.0])),
    Landmark("Right outer canthus", np.array([46.0, 70.0, -10.0])),
    Landmark("Left outer canthus", np.array([-43.0, 70.0, -10.0])),
    Landmark("Nose tip", np.array([2.0, 118.0, -42.0])),
    Landmark("Right tragus", np.array([79.0, -8.0, -34.0])),
)


def with_landmarks(scenario):
    """Return a scenario with landmarks."""
    return replace(scenario, landmarks=LANDMARKS)
