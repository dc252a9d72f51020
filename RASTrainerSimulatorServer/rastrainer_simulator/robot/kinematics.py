"""Where the robot's links are: one small interface, with Pinocchio or plain numpy behind it."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.robot.model import RobotModel

BACKENDS = ("pinocchio", "numpy")
VARIABLE = "RASTRAINER_KINEMATICS"


class Kinematics(Protocol):
    """Forward kinematics of a `RobotModel`; q is seven angles in rad, World in metres.

    It works in its own memory: each thread makes its own.
    """

    model: RobotModel

    def tip(self, q: Sequence[float]) -> np.ndarray:
        """Return ToolTipToWorld, (4, 4) float."""

    def links(self, q: Sequence[float]) -> dict[str, np.ndarray]:
        """Return LinkToWorld, (4, 4) float, of every link by its name."""

    def jacobian(self, q: Sequence[float]) -> np.ndarray:
        """Return the tip's Jacobian, (6, 7) float: m/rad, then rad/rad, along World's axes."""


def make_kinematics(model: RobotModel, backend: str | None = None) -> Kinematics:
    """Return the kinematics of `model`.

    `backend` is "pinocchio" or "numpy"; by default the environment variable RASTRAINER_KINEMATICS
    says which, else Pinocchio is used where it is installed (it has no wheels for Windows).
    """
    chosen = _chosen(backend)
    if chosen == "numpy":
        from rastrainer_simulator.robot.numpy_kinematics import NumpyKinematics

        return NumpyKinematics(model)
    if importlib.util.find_spec("pinocchio") is None:
        raise InputError(f"Pinocchio is not installed; set {VARIABLE}=numpy.")
    from rastrainer_simulator.robot.pinocchio_kinematics import PinocchioKinematics

    return PinocchioKinematics(model)


def kinematics_name(backend: str | None = None) -> str:
    """Return what `make_kinematics` computes with, and its version, such as "Pinocchio 3.9.0".

    Raises:
        InputError: there is no such backend.
    """
    if _chosen(backend) == "numpy":
        return f"numpy {np.__version__}"
    import pinocchio

    return f"Pinocchio {pinocchio.__version__}"


def _chosen(backend: str | None) -> str:
    chosen = backend or os.environ.get(VARIABLE) or _available()
    if chosen not in BACKENDS:
        raise InputError(f"{VARIABLE} is {chosen!r}; it should be one of {', '.join(BACKENDS)}.")
    return chosen


def _available() -> str:
    return "numpy" if importlib.util.find_spec("pinocchio") is None else "pinocchio"
