"""The robot as a value: joints, links, limits, tool tip and meshes, read from its URDF."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.urdf import Joint, MeshPart, RobotLink, read_urdf
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.srs_arm import CanonicalArm

FOLDER = ("robots", "iiwa7")
LENGTHS_M = (0.33999999999999997, 0.3999999999999999, 0.40000000000000024, 0.32600000000000007)
"""The shoulder's height, and the lengths to elbow, wrist and tip, as the least-squares fit of the
joints' axes gave them: recorded trials depend on their last bit."""
HOME = tuple(map(math.radians, (0.0, 30.0, 0.0, -90.0, 0.0, 60.0, 0.0)))
"""rad: the elbow is bent by 90°, the tool points straight down."""
_SUFFIXES = (".obj", ".ply", ".stl")
_GRAY = (0.8, 0.8, 0.8, 1.0)


@dataclass(frozen=True)
class RobotModel:
    """A 7R S-R-S arm. World is the frame of the root link; meters and radians."""

    name: str
    joints: tuple[Joint, ...]
    links: tuple[RobotLink, ...]  # parents before children, the tool's tip last
    arm: CanonicalArm
    meshes: tuple[MeshPart, ...]
    home: tuple[float, ...] = HOME

    @property
    def tip(self) -> RobotLink:
        return self.links[-1]

    @property
    def limits(self) -> np.ndarray:
        """(2, 7) float: lower and upper joint limits in rad."""
        return np.array([(joint.lower, joint.upper) for joint in self.joints]).T

    @property
    def velocity(self) -> np.ndarray:
        """(7,) float: joint velocity limits in rad/s."""
        return np.array([joint.velocity for joint in self.joints])

    @property
    def moving_links(self) -> tuple[RobotLink, ...]:
        """Links 0 to 7: the base, and the first link behind each joint."""
        first = {link.joint: link for link in reversed(self.links)}
        return tuple(first[joint] for joint in sorted(first))


def load_robot(mesh_folder: Path | None = None) -> RobotModel:
    """Return the KUKA LBR iiwa 7 R800; no mesh is opened.

    `mesh_folder` holds meshes to show instead of the robot's own. It follows the custom of robot
    descriptions: `visual/link_3.stl` (or .obj, .ply) is shown for the link whose name
    ends in `link_3`, else `link_3.stl`, else `collision/link_3.stl`. The arm moves and collides as
    with its own.
    """
    name, joints, links, meshes = read_urdf(asset_path(*FOLDER, "iiwa7.urdf"))
    if mesh_folder is not None:
        found = {link.name: _replacement(link.name, mesh_folder) for link in links}
        others = [
            MeshPart(link, path, np.eye(4), _GRAY, replaced=True)
            for link, path in found.items()
            if path is not None
        ]
        if not others:
            raise InputError(
                f"{mesh_folder} has no mesh for this robot; there should be files such as "
                "link_0.stl, visual/link_0.stl or collision/link_0.stl."
            )
        meshes = (*(part for part in meshes if found[part.link] is None), *others)
    signs = [float(joint.axis.sum()) for joint in joints]
    arm = CanonicalArm.of(*LENGTHS_M, signs=signs, joints=joints)
    return RobotModel(name, joints, links, arm, meshes)


def _replacement(link: str, folder: Path) -> Path | None:
    names = [link, *(link[i + 1 :] for i, letter in enumerate(link) if letter == "_")]
    places = (folder / "visual", folder, folder / "collision")
    paths = (place / f"{name}{end}" for place in places for name in names for end in _SUFFIXES)
    return next(filter(Path.is_file, paths), None)
