"""The robot as a value: joints, links, limits, tool tip and meshes, read from a URDF.

The URDF may be hostile: sizes, structure and numbers are checked before use. No mesh is opened.
"""

from __future__ import annotations

import io
import itertools
import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import plain_xml, read_bytes
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.srs_arm import Joint, SrsGeometry, srs_geometry
from rastrainer_simulator.vectors import vector

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
    """A 7R S-R-S arm. World is the frame of the URDF's root link; meters and radians."""

    name: str
    joints: tuple[Joint, ...]
    links: tuple[RobotLink, ...]  # parents before children
    tip: RobotLink
    home: tuple[float, ...]  # rad: elbow bent by 90°, tool straight down
    geometry: SrsGeometry
    meshes: tuple[MeshPart, ...]

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
    path = Path(urdf_path) if urdf_path else asset_path(*DEFAULT_URDF)
    robot = _read_urdf(path)
    joints, links = _walk(robot)
    meshes = _mesh_parts(robot, path.parent, Path(mesh_folder) if mesh_folder else None)
    return make_model(robot.name, joints, links, tip_link, meshes)


def make_model(
    name: str,
    joints: tuple[Joint, ...],
    links: tuple[RobotLink, ...],
    tip_link: str | None,
    meshes: tuple[MeshPart, ...],
) -> RobotModel:
    """Return the model of seven joints in a row; raises InputError as `load_robot`."""
    behind = {link.name: link for link in links if link.joint == 7}
    if tip_link is None:
        tip = max(behind.values(), key=lambda link: np.linalg.norm(link.offset[:3, 3]))
    elif tip_link in behind:
        tip = behind[tip_link]
    else:
        raise InputError(
            f"There is no tip link {tip_link}; behind the last joint are {', '.join(behind)}."
        )
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
            problem = ""
            if found.type not in _MOVABLE:
                problem = f"is {found.type}; only revolute joints can be used"
            elif found.mimic is not None:
                problem = "mimics another joint; each must move by itself"
            elif link.joint != len(joints):
                problem = "branches off: the seven joints must be in a row"
            if problem:
                raise InputError(f"Joint {found.name} {problem}.")
            axis = np.array([1.0, 0.0, 0.0]) if found.axis is None else found.axis
            endless = found.type == "continuous"
            joints.append(
                Joint(
                    name=found.name,
                    origin=_constant(origin),
                    axis=_constant(axis / np.linalg.norm(axis)),
                    lower=-_ENDLESS if endless else float(found.limit.lower or 0.0),
                    upper=_ENDLESS if endless else float(found.limit.upper or 0.0),
                    velocity=float(found.limit.velocity),
                )
            )
            links.append(RobotLink(found.child, len(joints), _constant(np.eye(4))))
    if len(joints) != 7:
        raise InputError(f"FABRIK needs seven revolute joints in a row, not {len(joints)}.")
    return tuple(joints), tuple(links)


def _constant(values: np.ndarray) -> np.ndarray:
    values = np.array(values, dtype=float)
    values.setflags(write=False)
    return values


LARGEST_FILE = 4 * 2**20
FARTHEST = 100.0
_MOVABLE = ("revolute", "continuous")


def _read_urdf(path: Path) -> yourdfpy.Robot:
    """Return the links and joints of a URDF whose tree and numbers have been checked.

    No mesh is opened. Raises InputError where the file cannot be read, is not plain XML, is not a
    tree of links, or holds unusable numbers.
    """
    # The import takes most of a second (trimesh, scipy), so it waits until a URDF is read.
    import yourdfpy

    text = plain_xml(read_bytes(path, LARGEST_FILE), f"The URDF {path}")
    root = ElementTree.fromstring(text).tag
    if root != "robot":
        raise InputError(f"The URDF {path} starts with <{root}>; it should start with <robot>.")
    try:
        robot = yourdfpy.URDF.load(
            io.BytesIO(text.encode()), build_scene_graph=False, load_meshes=False
        ).robot
    except Exception as error:  # a hostile file can break the parser anywhere
        raise InputError(
            f"{path} is not a usable URDF: an element lacks a name, a parent, a child or a number "
            f"({type(error).__name__}: {error})."
        ) from error
    _check_tree(robot, path)
    for joint in robot.joints:
        _check_joint(joint, path)
    return robot


def _check_tree(robot: yourdfpy.Robot, path: Path) -> None:
    links = {link.name for link in robot.links}
    if not links or len(links) < len(robot.links):
        raise InputError(f"The URDF {path} has no link, or two links of one name.")
    if len({joint.name for joint in robot.joints}) < len(robot.joints):
        raise InputError(f"The URDF {path} has two joints of one name.")
    parent_of = {joint.child: joint.parent for joint in robot.joints}
    if not links.issuperset(parent_of) or not links.issuperset(parent_of.values()):
        raise InputError(f"The URDF {path} has a joint whose parent or child link is missing.")
    # As many joints as links but one, each with its own child, and every link leads to one root.
    if not len(parent_of) == len(robot.joints) == len(links) - 1:
        raise InputError(f"The links of the URDF {path} do not form one tree.")
    reached = links - set(parent_of)
    while grown := {link for link, parent in parent_of.items() if parent in reached} - reached:
        reached |= grown
    if reached != links:
        raise InputError(f"The links of the URDF {path} do not form one tree.")


def _check_joint(joint: yourdfpy.Joint, path: Path) -> None:
    where = f"Joint {joint.name} of the URDF {path}"
    if joint.origin is not None and not np.all(np.abs(joint.origin) <= FARTHEST):
        raise InputError(f"{where} has an origin that is not finite, or beyond {FARTHEST:g} m.")
    if joint.type not in _MOVABLE:
        return
    if joint.axis is not None:
        length = np.linalg.norm(joint.axis) if joint.axis.shape == (3,) else math.nan
        if not 1e-6 < length < 1e6:
            raise InputError(f"{where} has an axis that is not a direction of three numbers.")
    limit = joint.limit
    if limit is None or limit.velocity is None or not 0.0 < limit.velocity < math.inf:
        raise InputError(f"{where} needs a velocity limit above zero.")
    if joint.type == "revolute":
        lower, upper = limit.lower or 0.0, limit.upper or 0.0
        if not -1e4 < lower < upper < 1e4:
            raise InputError(f"{where} needs a lower limit below its upper limit.")


KINDS = ("visual", "collision")
_SUFFIXES = (".glb", ".dae", ".obj", ".ply", ".stl")
Color = tuple[float, float, float, float]
"""RGBA, 0…1."""
_GRAY = (0.8, 0.8, 0.8, 1.0)


@dataclass(frozen=True)
class MeshPart:
    """One mesh of a link."""

    link: str
    kind: str  # "visual" or "collision"
    path: Path
    origin: np.ndarray  # (4, 4) float: the mesh's frame to the link's frame, m
    scale: tuple[float, float, float]
    color: Color
    replaced: bool = False  # used instead of the URDF's own mesh


def _mesh_parts(
    robot: yourdfpy.Robot, urdf_folder: Path, mesh_folder: Path | None
) -> tuple[MeshPart, ...]:
    """Return the meshes that a URDF names, or those of `mesh_folder` where it has one for a link.

    `mesh_folder` follows the custom of robot descriptions: `visual/link_3.stl` (or .dae, .obj,
    .ply, .glb) replaces what the link whose name ends in `link_3` shows, `collision/link_3.stl`
    what it collides with, and a plain `link_3.stl` both. Without any visual mesh for a link, its
    collision mesh is shown. Raises InputError where `mesh_folder` fits no link, and where a mesh
    lies outside of the folder in which it is looked for.
    """
    colors = {
        material.name: _rgba(material) for material in robot.materials if material.color is not None
    }
    parts: list[MeshPart] = []
    replaced = False
    for link in robot.links:
        for kind in KINDS:
            other = _replacement(link.name, kind, mesh_folder) if mesh_folder else None
            if other:
                replaced = True
                parts.append(MeshPart(link.name, kind, other, np.eye(4), (1.0,) * 3, _GRAY, True))
            else:
                parts.extend(_own_parts(link, kind, urdf_folder, colors))
    if mesh_folder and not replaced:
        raise InputError(
            f"{mesh_folder} has no mesh for this robot; there should be files such as "
            "link_0.stl, visual/link_0.stl or collision/link_0.stl."
        )
    return tuple(parts)


def _replacement(link: str, kind: str, folder: Path) -> Path | None:
    names = [link, *(link[i + 1 :] for i, letter in enumerate(link) if letter == "_")]
    for place in (folder / kind, folder, folder / "collision"):
        for name, suffix in itertools.product(names, _SUFFIXES):
            path = mesh_inside(folder, place / f"{name}{suffix}", link)
            if path.is_file():
                return path
    return None


def _own_parts(
    link: yourdfpy.Link, kind: str, folder: Path, colors: dict[str, Color]
) -> list[MeshPart]:
    parts = []
    for shape in link.visuals if kind == "visual" else link.collisions:
        mesh = shape.geometry.mesh if shape.geometry else None
        if mesh is None or not mesh.filename:
            continue
        name = mesh.filename.partition("://")[2].partition("/")[2] or mesh.filename
        scale = np.broadcast_to(1.0 if mesh.scale is None else mesh.scale, 3)
        origin = np.eye(4) if shape.origin is None else shape.origin
        material, color = getattr(shape, "material", None), _GRAY
        if material is not None:
            named = colors.get(material.name, _GRAY)
            color = named if material.color is None else _rgba(material)
        parts.append(
            MeshPart(
                link.name,
                kind,
                mesh_inside(folder, folder / name, link.name),
                origin,
                vector(scale),
                color,
            )
        )
    return parts


def mesh_inside(folder: Path, path: Path, link: str) -> Path:
    """Return `path`, which a file names for a link."""
    try:
        is_inside = path.resolve().is_relative_to(folder.resolve())
    except (OSError, ValueError, RuntimeError):  # such as a ring of symbolic links
        is_inside = False
    if not is_inside:
        raise InputError(f"The mesh {path} of {link} must be in {folder} or below it.")
    return path


def _rgba(material: yourdfpy.Material) -> Color:
    red, green, blue, opacity = map(float, material.color.rgba)
    return red, green, blue, opacity
