"""pin-pink, set up to solve the same problems as FABRIK, and the judge of both."""

import numpy as np
import pink
import pinocchio as pin
from pink.tasks import FrameTask

from rastrainer_simulator.assets import asset_path

TIP = "iiwa_tool_tip_ee"
TOLERANCE_M = 1e-4
TOLERANCE_RAD = 1e-3
MAX_STEPS = 100
# How much a turn of the tip about its x, y and z axes counts in each mode.
TURNS = {"position": (0.0, 0.0, 0.0), "direction": (1.0, 1.0, 0.0), "pose": (1.0, 1.0, 1.0)}


class Pinocchio:
    """The robot as Pinocchio reads it: the judge of every solution, and pin-pink's model."""

    def __init__(self) -> None:
        self.model = pin.buildModelFromUrdf(str(asset_path("robots", "iiwa7", "iiwa7.urdf")))
        self.data = self.model.createData()
        self.frame = self.model.getFrameId(TIP)
        self.lower, self.upper = self.model.lowerPositionLimit, self.model.upperPositionLimit
        self.velocity = self.model.velocityLimit

    def tip(self, q: np.ndarray) -> pin.SE3:
        pin.forwardKinematics(self.model, self.data, q)
        return pin.updateFramePlacement(self.model, self.data, self.frame)

    def errors(self, q: np.ndarray, target: pin.SE3, mode: str) -> tuple[float, float]:
        """Return how far the tip is from a target, m and rad; rad is 0 if turns do not count."""
        tip = self.tip(q)
        turn = pin.log3(tip.rotation.T @ target.rotation)
        if mode == "direction":
            turn = np.cross(tip.rotation[:, 2], target.rotation[:, 2])
        off = np.linalg.norm(tip.translation - target.translation)
        return float(off), float(np.linalg.norm(turn)) if mode != "position" else 0.0


class PinPink:
    """Quadratic programs by pin-pink with the solver DAQP, within the joint limits."""

    name = "pin-pink"

    def __init__(self, robot: Pinocchio) -> None:
        self._robot = robot

    def question(self, target: pin.SE3, mode: str) -> tuple[pin.SE3, str]:
        return target, mode

    def solve(self, question: tuple[pin.SE3, str], q_start: np.ndarray) -> np.ndarray | None:
        target, mode = question
        robot = self._robot
        configuration = pink.Configuration(
            robot.model, robot.data, np.array(q_start), copy_data=False
        )
        task = FrameTask(TIP, position_cost=1.0, orientation_cost=TURNS[mode], lm_damping=1e-3)
        task.set_target(target)
        limits = [robot.model.configuration_limit]
        turns = np.array(TURNS[mode]) > 0.0
        for _ in range(MAX_STEPS):
            error = task.compute_error(configuration)
            off, turned = np.linalg.norm(error[:3]), np.linalg.norm(error[3:][turns])
            if off <= TOLERANCE_M and turned <= TOLERANCE_RAD:
                return configuration.q
            try:
                velocity = pink.solve_ik(configuration, [task], 1.0, solver="daqp", limits=limits)
            except pink.exceptions.PinkError:
                return None
            configuration.integrate_inplace(velocity, 1.0)
        return None
