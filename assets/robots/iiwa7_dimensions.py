"""Published kinematic and physical data of the KUKA LBR iiwa 7 R800, and of our pointer tool.

Meters, kilograms, degrees (turned into radians by the URDF writer), at the joint angles zero.
"""

from dataclasses import dataclass

Vector = tuple[float, float, float]
Color = tuple[float, float, float, float]


@dataclass(frozen=True)
class Joint:
    """A revolute joint: its origin in the parent's frame (m), axis, and limits."""

    name: str
    origin: Vector
    axis: Vector
    limit_deg: float
    speed_deg_s: float
    torque_nm: float


LINK_PREFIX = "iiwa_link_"
TOOL_LINK = "iiwa_link_tool"
TOOL_TIP_LINK = "iiwa_tool_tip_ee"

JOINTS = (
    Joint("iiwa_joint_1", (0.0, 0.0, 0.1475), (0, 0, 1), 170, 98, 176),
    Joint("iiwa_joint_2", (0.0, -0.0105, 0.1925), (0, 1, 0), 120, 98, 176),
    Joint("iiwa_joint_3", (0.0, 0.0105, 0.2075), (0, 0, 1), 170, 100, 110),
    Joint("iiwa_joint_4", (0.0, 0.0105, 0.1925), (0, -1, 0), 120, 130, 110),
    Joint("iiwa_joint_5", (0.0, -0.0105, 0.2075), (0, 0, 1), 170, 140, 110),
    Joint("iiwa_joint_6", (0.0, -0.0707, 0.1925), (0, 1, 0), 120, 180, 40),
    Joint("iiwa_joint_7", (0.0, 0.0707, 0.0910), (0, 0, 1), 175, 180, 40),
)
FLANGE_OFFSET = 0.035
TOOL_LENGTH = 0.2
ARM = {
    "shoulder": 0.33999999999999997,
    "upper": 0.3999999999999999,
    "fore": 0.40000000000000024,
    "tool": 0.32600000000000007,
}
"""The shoulder's height, and the lengths to elbow, wrist and tip, as the least-squares fit of the
joints' axes gave them: recorded trials depend on their last bit."""

LINK_MASSES = (4.855658, 3.394011, 4.031991, 3.394011, 4.031989, 1.529239, 2.403626, 0.259474)
TOOL_MASS = 0.25

LINK_NAMES = (*(f"{LINK_PREFIX}{number}" for number in range(len(LINK_MASSES))), TOOL_LINK)
MASSES = dict(zip(LINK_NAMES, (*LINK_MASSES, TOOL_MASS), strict=True))

COLORS: dict[str, Color] = {
    "gray": (0.75, 0.76, 0.77, 1.0),
    "orange": (0.95, 0.40, 0.05, 1.0),
    "dark": (0.10, 0.10, 0.11, 1.0),
    "metal": (0.62, 0.63, 0.65, 1.0),
    "blue": (0.05, 0.25, 0.95, 1.0),
}
