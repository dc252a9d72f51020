"""Forward kinematics by Pinocchio. Only what is asked for is read: copying all frames is slow."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pinocchio as pin

from rastrainer_simulator.robot.model import RobotModel


class PinocchioKinematics:
    """Implements `kinematics.Kinematics`."""

    def __init__(self, model: RobotModel) -> None:
        self.model = model
        self._pin = pin.Model()
        joint = 0
        for found in model.joints:
            placement = pin.SE3(found.origin)
            joint = self._pin.addJoint(
                joint, pin.JointModelRevoluteUnaligned(found.axis), placement, found.name
            )
        inertia = pin.Inertia.Zero()
        frames = [
            self._pin.addFrame(
                pin.Frame(link.name, link.joint, pin.SE3(link.offset), pin.FrameType.BODY, inertia)
            )
            for link in model.links
        ]
        self._links = dict(zip(model.link_names, frames, strict=True))
        self._tip = self._links[model.tip.name]
        self._data = self._pin.createData()

    def tip(self, q: Sequence[float]) -> np.ndarray:
        """Return ToolTipToWorld, (4, 4) float."""
        pin.forwardKinematics(self._pin, self._data, np.asarray(q, dtype=float))
        return pin.updateFramePlacement(self._pin, self._data, self._tip).homogeneous

    def links(self, q: Sequence[float]) -> dict[str, np.ndarray]:
        """Return LinkToWorld, (4, 4) float, of every link by its name."""
        pin.framesForwardKinematics(self._pin, self._data, np.asarray(q, dtype=float))
        # One by one they take ten times as long.
        placements = self._data.oMf.tolist()
        return {name: placements[frame].homogeneous for name, frame in self._links.items()}

    def jacobian(self, q: Sequence[float]) -> np.ndarray:
        """Return the tip's Jacobian, (6, 7) float: m/rad, then rad/rad, along World's axes."""
        frame = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
        angles = np.asarray(q, dtype=float)
        return pin.computeFrameJacobian(self._pin, self._data, angles, self._tip, frame)
