"""What is planned on the patient's images: further targets and a trajectory."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.files.json_fields import Fields
from rastrainer.head.mesh import RAS_LIMIT_MM

MOST_TARGETS = 20
SHORTEST_TRAJECTORY_MM = 1.0


@dataclass(frozen=True)
class PlannedTarget:
    """A point to be reached, such as a tumor's center.

    Attributes:
        name: for people.
        position: (3,) float, RAS mm.
    """

    name: str
    position: np.ndarray


@dataclass(frozen=True)
class PlannedTrajectory:
    """A straight path into the head.

    Attributes:
        name: for people.
        entry: (3,) float, RAS mm, where it enters.
        target: (3,) float, RAS mm, where it ends.
    """

    name: str
    entry: np.ndarray
    target: np.ndarray


def read_targets(fields: Fields) -> tuple[PlannedTarget, ...]:
    """Return the optional field `targets`.

    Raises:
        InputError: it is there and cannot be used.
    """
    if "targets" not in fields.names():
        return ()
    entries = fields.list_of_fields("targets", 0, MOST_TARGETS)
    return tuple(
        PlannedTarget(entry.text("name", 60), _point(entry, "positionRas")) for entry in entries
    )


def read_trajectory(fields: Fields) -> PlannedTrajectory | None:
    """Return the optional field `trajectory`.

    Raises:
        InputError: it is there and cannot be used.
    """
    if "trajectory" not in fields.names():
        return None
    own = fields.fields("trajectory")
    entry, target = _point(own, "entryRas"), _point(own, "targetRas")
    if np.linalg.norm(target - entry) < SHORTEST_TRAJECTORY_MM:
        raise own.error("entryRas", f"at least {SHORTEST_TRAJECTORY_MM:g} mm from targetRas")
    return PlannedTrajectory(own.text("name", 60), entry, target)


def _point(fields: Fields, name: str) -> np.ndarray:
    point = np.array(fields.numbers(name, 3, RAS_LIMIT_MM), dtype=float)
    point.setflags(write=False)
    return point
