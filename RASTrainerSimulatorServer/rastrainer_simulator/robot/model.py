"""The robot as a value: joints, links, limits, tool tip and meshes, read from a URDF."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.mesh_files import MeshPart, mesh_parts
from rastrainer_simulator.robot.srs_geometry import Joint, SrsGeometry, srs_geometry

if TYPE_CHECKING:
    import yourdfpy

DEFAULT_URDF = ("robots", "iiwa7", "iiwa7.urdf")

# A joint without end: more turns than any session makes, but a number that can be sent and saved.
_ENDLESS = 1000.0 * 2.0 * math.pi


@dataclass(frozen=True)
class RobotLink:
    """A link, rigidly fixed to a joint's frame."""

    name: str
    joint: int  # how many movable joints are before it: 0 is the base, 7 the flange
    offset: np.ndarray  # (4, 4) float: this link's frame to the frame of that joint, m


@dataclass(frozen=True)
class RobotModel:
    """A 7R S-R-S arm. World is the frame of the URDF's root link; metres and radians."""

    name: str
    joints: tuple[Joint, ...]
    links: tuple[RobotLink, ...]
    tip: RobotLink
    home: tuple[float, ...]  # rad: elbow bent by 90°, tool straight down
    geometry: SrsGeometry
    meshes: tuple[MeshPart, ...]

    @property
    def link_names(self) -> tuple[str, ...]:
        """Every link, parents before children."""
        return tuple(link.name for link in self.links)

    @property
    def lower(self) -> np.ndarray:
        """(7,) float: lower joint limits in rad."""
        return np.array([joint.lower for joint in self.joints])

    @property
    def upper(self) -> np.ndarray:
        """(7,) float: upper joint limits in rad."""
        return np.array([joint.upper for joint in self.joints])

    @property
    def velocity(self) -> np.ndarray:
        """(7,) float: joint velocity limits in rad/s."""
        return np.array([joint.velocity for joint in self.joints])


def load_robot(
    urdf_path: str | Path | None = None,
    mesh_folder: str | Path | None = None,
    tip_link: str | None = None,
) -> RobotModel:
    """Read a robot; by default the KUKA LBR iiwa 7 R800 that comes with RASTrainer.

    `mesh_folder` holds meshes to show instead of the URDF's own. `tip_link` names the tool tip; by
    default it is the outermost link behind the last joint. No mesh is opened here.
    Raises InputError for an unusable file and for a robot that is not a 7R S-R-S arm.
    """
    # The import takes most of a second (trimesh, scipy), so it waits until a URDF is read.
    from rastrainer_simulator.robot.urdf import read_urdf

    path = Path(urdf_path) if urdf_path else asset_path(*DEFAULT_URDF)
    robot = read_urdf(path)
    joints, links = _walk(robot)
    meshes = mesh_parts(robot, path.parent, Path(mesh_folder) if mesh_folder else None)
    return make_model(robot.name, joints, links, tip_link, meshes)


def make_model(
    name: str,
    joints: tuple[Joint, ...],
    links: tuple[RobotLink, ...],
    tip_link: str | None,
    meshes: tuple[MeshPart, ...],
) -> RobotModel:
    """Return the model of seven joints in a row; raises InputError as `load_robot`."""
    tip = _find_tip(links, tip_link)
    geometry = srs_geometry(joints, tip.offset)
    return RobotModel(name, joints, links, tip, geometry.home(), geometry, meshes)


def _walk(robot: yourdfpy.Robot) -> tuple[tuple[Joint, ...], tuple[RobotLink, ...]]:
    """Follow the tree from its root; fixed joints are merged into the links' offsets."""
    children: dict[str, list[yourdfpy.Joint]] = {}
    for joint in robot.joints:
        children.setdefault(joint.parent, []).append(joint)
    root = ({link.name for link in robot.links} - {joint.child for joint in robot.joints}).pop()
    joints: list[Joint] = []
    links = [RobotLink(root, 0, _constant(np.eye(4)))]
    for link in links:  # grows while it is walked
        for found in children.get(link.name, ()):
            origin = link.offset if found.origin is None else link.offset @ found.origin
            if found.type == "fixed":
                links.append(RobotLink(found.child, link.joint, _constant(origin)))
                continue
            _check_serial(found, link, joints)
            joints.append(_movable(found, origin))
            links.append(RobotLink(found.child, len(joints), _constant(np.eye(4))))
    if len(joints) != 7:
        raise InputError(f"FABRIK here needs seven revolute joints in a row, not {len(joints)}.")
    return tuple(joints), tuple(links)


def _check_serial(found: yourdfpy.Joint, link: RobotLink, joints: list[Joint]) -> None:
    if found.type not in ("revolute", "continuous"):
        raise InputError(f"Joint {found.name} is {found.type}; only revolute joints can be used.")
    if found.mimic is not None:
        raise InputError(f"Joint {found.name} mimics another joint; each must move by itself.")
    if link.joint != len(joints):
        raise InputError(f"Joint {found.name} branches off: the seven joints must be in a row.")


def _movable(found: yourdfpy.Joint, origin: np.ndarray) -> Joint:
    axis = np.array([1.0, 0.0, 0.0]) if found.axis is None else found.axis
    endless = found.type == "continuous"
    return Joint(
        name=found.name,
        origin=_constant(origin),
        axis=_constant(axis / np.linalg.norm(axis)),
        lower=-_ENDLESS if endless else float(found.limit.lower or 0.0),
        upper=_ENDLESS if endless else float(found.limit.upper or 0.0),
        velocity=float(found.limit.velocity),
    )


def _find_tip(links: tuple[RobotLink, ...], name: str | None) -> RobotLink:
    behind = {link.name: link for link in links if link.joint == 7}
    if name is None:
        return max(behind.values(), key=lambda link: np.linalg.norm(link.offset[:3, 3]))
    if name not in behind:
        raise InputError(
            f"There is no tip link {name}; behind the last joint are {', '.join(behind)}."
        )
    return behind[name]


def _constant(values: np.ndarray) -> np.ndarray:
    values = np.array(values, dtype=float)
    values.setflags(write=False)
    return values
