"""The robot as a value: joints, links, limits, tool tip and meshes, read from `prepared.json`.

`assets/robots/make_iiwa7.py` writes that file with the URDF, exact to the last bit: the packages
that read URDF and meshes take a second to import and 90 MB.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.srs_arm import CanonicalArm, Joint

FOLDER = ("robots", "iiwa7")
PREPARED_NAME = "prepared.json"
MAX_BYTES = 2**20
_KINDS = ("visual", "collision")
_SUFFIXES = (".glb", ".dae", ".obj", ".ply", ".stl")
HOME = tuple(map(math.radians, (0.0, 30.0, 0.0, -90.0, 0.0, 60.0, 0.0)))
"""rad: the elbow is bent by 90°, the tool points straight down."""
_GRAY = (0.8, 0.8, 0.8, 1.0)


@dataclass(frozen=True)
class RobotLink:
    """A link, rigidly fixed to a joint's frame."""

    name: str
    joint: int  # how many movable joints are before it: 0 is the base, 7 the flange
    offset: np.ndarray  # (4, 4) float: this link's frame to the frame of that joint, m


@dataclass(frozen=True)
class MeshPart:
    """One mesh of a link."""

    link: str
    kind: str  # "visual" or "collision"
    path: Path
    origin: np.ndarray  # (4, 4) float: the mesh's frame to the link's frame, m
    scale: tuple[float, ...]
    color: tuple[float, ...]  # RGBA, 0…1
    replaced: bool = False  # used instead of the robot's own mesh


@dataclass(frozen=True)
class RobotModel:
    """A 7R S-R-S arm. World is the frame of the root link; meters and radians."""

    name: str
    joints: tuple[Joint, ...]
    links: tuple[RobotLink, ...]  # parents before children
    tip: RobotLink
    arm: CanonicalArm
    meshes: tuple[MeshPart, ...]
    home: tuple[float, ...] = HOME

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


@cache
def read_prepared() -> Mapping[str, Any]:
    """Return `model` and `shape` of the KUKA LBR iiwa 7 R800 that comes with RASTrainer, JSON."""
    prepared: Mapping[str, Any] = read_json(asset_path(*FOLDER, PREPARED_NAME), MAX_BYTES)
    return prepared


def load_robot(mesh_folder: Path | None = None) -> RobotModel:
    """Return the KUKA LBR iiwa 7 R800; no mesh is opened.

    `mesh_folder` holds meshes to show instead of the robot's own.
    """
    model = robot_model(read_prepared()["model"], asset_path(*FOLDER), mesh_folder)
    if mesh_folder and not any(part.replaced for part in model.meshes):
        raise InputError(
            f"{mesh_folder} has no mesh for this robot; there should be files such as "
            "link_0.stl, visual/link_0.stl or collision/link_0.stl."
        )
    return model


def robot_model(value: Mapping[str, Any], folder: Path, other: Path | None = None) -> RobotModel:
    """Return the model of a JSON object whose mesh files are below `folder`.

    The folder `other` follows the custom of robot descriptions: `visual/link_3.stl` (or .dae, .obj,
    .ply, .glb) replaces the visual meshes of the link whose name ends in `link_3`,
    `collision/link_3.stl` its collision meshes, and a plain `link_3.stl` both. A link without a
    visual mesh there shows its collision mesh.
    """
    joints = tuple(
        Joint(**each | {name: np.array(each[name]) for name in ("origin", "axis")})
        for each in value["joints"]
    )
    links = tuple(
        RobotLink(each["name"], each["joint"], np.array(each["offset"])) for each in value["links"]
    )
    own = [
        MeshPart(
            each["link"],
            each["kind"],
            folder / each["path"],
            np.array(each["origin"]),
            tuple(each["scale"]),
            tuple(each["color"]),
        )
        for each in value["meshes"]
    ]
    meshes: list[MeshPart] = []
    for link, kind in itertools.product(links, _KINDS):
        path = _replacement(link.name, kind, other) if other else None
        if path:
            meshes.append(MeshPart(link.name, kind, path, np.eye(4), (1.0,) * 3, _GRAY, True))
        else:
            meshes.extend(part for part in own if (part.link, part.kind) == (link.name, kind))
    tip = next(link for link in links if link.name == value["tip"])
    arm = CanonicalArm.of(**value["arm"], joints=joints)
    return RobotModel(value["name"], joints, links, tip, arm, tuple(meshes))


def _replacement(link: str, kind: str, folder: Path) -> Path | None:
    names = [link, *(link[i + 1 :] for i, letter in enumerate(link) if letter == "_")]
    places = (folder / kind, folder, folder / "collision")
    paths = (place / f"{name}{end}" for place in places for name in names for end in _SUFFIXES)
    return next(filter(Path.is_file, paths), None)
