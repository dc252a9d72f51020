"""Anatomical landmarks of a head, placed once on its images: places that a trainee has to find."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.files.json_fields import Fields
from rastrainer.head.mesh import RAS_LIMIT_MM

MAX_LANDMARKS = 15


@dataclass(frozen=True)
class Landmark:
    """A landmark.

    Attributes:
        name: such as "Nasion", by which it is asked for.
        position: (3,) float, RAS mm.
    """

    name: str
    position: np.ndarray


def read_landmarks(fields: Fields) -> tuple[Landmark, ...]:
    """Return the optional field `landmarks` of a scenario, in the order of touching.

    Raises:
        InputError: it is invalid.
    """
    if "landmarks" not in fields.names():
        return ()
    landmarks: dict[str, Landmark] = {}
    for entry in fields.list_of_fields("landmarks", 0, MAX_LANDMARKS):
        name = entry.text("name", 40)
        if name in landmarks:
            raise entry.error("name", "another name than that of each landmark before")
        landmarks[name] = Landmark(name, entry.point("positionRas", RAS_LIMIT_MM))
    return tuple(landmarks.values())
