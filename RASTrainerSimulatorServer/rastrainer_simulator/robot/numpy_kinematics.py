"""Forward kinematics by plain numpy, for platforms without Pinocchio."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from rastrainer_simulator.robot.model import RobotModel

_NEXT, _AFTER_NEXT = [1, 2, 0], [2, 0, 1]


class NumpyKinematics:
    """Implements `kinematics.Kinematics`."""

    def __init__(self, model: RobotModel) -> None:
        self.model = model
        origins = np.array([joint.origin for joint in model.joints])
        skew = np.zeros((7, 4, 4))
        for index, joint in enumerate(model.joints):
            skew[index, :3, :3] = np.cross(joint.axis, np.eye(3)).T
        # Rodrigues: origin · (I + sin q K + (1 − cos q) K²), so one multiplication a call.
        self._still, self._sine, self._versine = origins, origins @ skew, origins @ skew @ skew
        self._names = model.link_names
        self._joint_of_link = [link.joint for link in model.links]
        self._offsets = np.array([link.offset for link in model.links])
        self._axes = np.array([joint.axis for joint in model.joints])[:, :, None]
        self._frames = np.tile(np.eye(4), (8, 1, 1))

    def tip(self, q: Sequence[float]) -> np.ndarray:
        """Return ToolTipToWorld, (4, 4) float."""
        return self._move(q)[7] @ self.model.tip.offset

    def links(self, q: Sequence[float]) -> dict[str, np.ndarray]:
        """Return LinkToWorld, (4, 4) float, of every link by its name."""
        poses = self._move(q)[self._joint_of_link] @ self._offsets
        return dict(zip(self._names, poses, strict=True))

    def jacobian(self, q: Sequence[float]) -> np.ndarray:
        """Return the tip's Jacobian, (6, 7) float: m/rad, then rad/rad, along World's axes."""
        frames = self._move(q)[1:]
        axes = (frames[:, :3, :3] @ self._axes)[:, :, 0]
        arms = (frames[6] @ self.model.tip.offset[:, 3])[:3] - frames[:, :3, 3]
        turns = axes[:, _NEXT] * arms[:, _AFTER_NEXT] - axes[:, _AFTER_NEXT] * arms[:, _NEXT]
        return np.concatenate((turns, axes), axis=1).T

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
