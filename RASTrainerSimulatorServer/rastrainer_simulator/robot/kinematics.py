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
    """Forward kinematics of a `RobotModel`; q is seven angles in rad, World in meters.

    It works in its own memory: each thread makes its own.
    """

    model: RobotModel

    def tip(self, q: Sequence[float]) -> np.ndarray:
        """Return ToolTipToWorld, (4, 4) float."""

    def links(self, q: Sequence[float]) -> dict[str, np.ndarray]:
        """Return LinkToWorld, (4, 4) float, of every link by its name."""


def make_kinematics(model: RobotModel, backend: str | None = None) -> Kinematics:
    """Return the kinematics of `model`.

    `backend` is "pinocchio" or "numpy"; by default the environment variable RASTRAINER_KINEMATICS
    decides, else Pinocchio is used if it is installed (it has no wheels for Windows).
    """
    if _chosen(backend) == "numpy":
        return NumpyKinematics(model)
    return PinocchioKinematics(model)


def kinematics_name() -> str:
    """Return what `make_kinematics` computes with, and its version, such as "Pinocchio 3.9.0"."""
    if _chosen(None) == "numpy":
        return f"numpy {np.__version__}"
    import pinocchio

    return f"Pinocchio {pinocchio.__version__}"


def _chosen(backend: str | None) -> str:
    has_pinocchio = importlib.util.find_spec("pinocchio") is not None
    chosen = backend or os.environ.get(VARIABLE) or ("pinocchio" if has_pinocchio else "numpy")
    if chosen == "pinocchio" and not has_pinocchio:
        raise InputError(f"Pinocchio is not installed; set {VARIABLE}=numpy.")
    if chosen not in BACKENDS:
        raise InputError(f"{VARIABLE} is {chosen!r}; it should be one of {', '.join(BACKENDS)}.")
    return chosen


class NumpyKinematics:
    """Kinematics by numpy alone."""

    def __init__(self, model: RobotModel) -> None:
        self.model = model
        origins = np.array([joint.origin for joint in model.joints])
        skew = np.zeros((7, 4, 4))
        for index, joint in enumerate(model.joints):
            skew[index, :3, :3] = np.cross(joint.axis, np.eye(3)).T
        # Rodrigues: origin · (I + sin q K + (1 − cos q) K²), so one multiplication a call.
        self._still, self._sine, self._versine = origins, origins @ skew, origins @ skew @ skew
        self._names = [link.name for link in model.links]
        self._joint_of_link = [link.joint for link in model.links]
        self._offsets = np.array([link.offset for link in model.links])
        self._frames = np.tile(np.eye(4), (8, 1, 1))

    def tip(self, q: Sequence[float]) -> np.ndarray:
        return self._move(q)[7] @ self.model.tip.offset

    def links(self, q: Sequence[float]) -> dict[str, np.ndarray]:
        poses = self._move(q)[self._joint_of_link] @ self._offsets
        return dict(zip(self._names, poses, strict=True))

    def _move(self, q: Sequence[float]) -> np.ndarray:
        """Return the base's and the seven movable frames in World, (8, 4, 4) float.

        A running product in three batched steps (Hillis and Steele 1986) instead of seven.
        """
        angles = np.asarray(q, dtype=float)[:, None, None]
        frames = self._frames
        chain = frames[1:]
        chain[:] = self._still + np.sin(angles) * self._sine
        chain += (1.0 - np.cos(angles)) * self._versine
        for reach in (1, 2, 4):
            chain[reach:] = chain[:-reach] @ chain[reach:]
        return frames


class PinocchioKinematics:
    """Kinematics by Pinocchio. Only the needed frames are read: copying all of them is slow."""

    def __init__(self, model: RobotModel) -> None:
        import pinocchio as pin

        self.model = model
        self._pin = pin
        self._model = pin.Model()
        joint = 0
        for found in model.joints:
            placement = pin.SE3(found.origin)
            joint = self._model.addJoint(
                joint, pin.JointModelRevoluteUnaligned(found.axis), placement, found.name
            )
        inertia = pin.Inertia.Zero()
        frames = [
            self._model.addFrame(
                pin.Frame(link.name, link.joint, pin.SE3(link.offset), pin.FrameType.BODY, inertia)
            )
            for link in model.links
        ]
        self._links = {link.name: frame for link, frame in zip(model.links, frames, strict=True)}
        self._tip = self._links[model.tip.name]
        self._data = self._model.createData()

    def tip(self, q: Sequence[float]) -> np.ndarray:
        self._pin.forwardKinematics(self._model, self._data, np.asarray(q, dtype=float))
        return self._pin.updateFramePlacement(self._model, self._data, self._tip).homogeneous

    def links(self, q: Sequence[float]) -> dict[str, np.ndarray]:
        self._pin.framesForwardKinematics(self._model, self._data, np.asarray(q, dtype=float))
        # Individually they take ten times as long.
        placements = self._data.oMf.tolist()
        return {name: placements[frame].homogeneous for name, frame in self._links.items()}
