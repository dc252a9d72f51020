"""Read the description of a robot arm (URDF): its chain of joints, and the meshes of its links."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.reading import read_bytes

MAX_BYTES = 2**20


@dataclass(frozen=True)
class Joint:
    """A revolute joint: where it sits on the link before it, and how it may move."""

    name: str
    origin: np.ndarray  # (4, 4) float: this joint's frame to the movable frame before it, m
    axis: np.ndarray  # (3,) float: unit vector in this joint's frame
    lower: float  # rad
    upper: float  # rad
    velocity: float  # rad/s


@dataclass(frozen=True)
class RobotLink:
    """A link, rigidly fixed to a joint's frame."""

    name: str
    joint: int  # how many movable joints are before it: 0 is the base, 7 the flange
    offset: np.ndarray  # (4, 4) float: this link's frame to the frame of that joint, m


@dataclass(frozen=True)
class MeshPart:
    """One mesh that shows a link."""

    link: str
    path: Path
    origin: np.ndarray  # (4, 4) float: the mesh's frame to the link's frame, m
    color: tuple[float, ...]  # RGBA, 0…1
    replaced: bool = False  # used instead of the robot's own mesh


class RobotDescription(NamedTuple):
    """A chain of joints from the base to the tip of the tool, and its meshes."""

    name: str
    joints: tuple[Joint, ...]
    links: tuple[RobotLink, ...]  # parents before children
    meshes: tuple[MeshPart, ...]


def read_urdf(path: Path) -> RobotDescription:
    """Return the robot of a file; no mesh is opened."""
    what, text = f"The URDF {path}", read_bytes(path, MAX_BYTES)
    try:
        root = ElementTree.fromstring(text)
        joints, links = _chain(root.findall("joint"))
        colors = {
            material.get("name"): tuple(_numbers(_attribute(material, "color", "rgba")).tolist())
            for material in root.findall("material")
        }
        meshes = tuple(
            MeshPart(
                link.get("name", ""),
                path.parent / _attribute(visual, "geometry/mesh", "filename"),
                _origin(visual),
                colors[_attribute(visual, "material", "name")],
            )
            for link in root.findall("link")
            for visual in link.findall("visual")
        )
    except (KeyError, ValueError, ElementTree.ParseError) as error:
        raise InputError(f"{what} cannot be used: {error}.") from None
    return RobotDescription(root.get("name", ""), joints, links, meshes)


def _chain(elements: list[ElementTree.Element]) -> tuple[tuple[Joint, ...], tuple[RobotLink, ...]]:
    following = {_attribute(each, "parent", "link"): each for each in elements}
    first = following.keys() - {_attribute(each, "child", "link") for each in elements}
    joints: list[Joint] = []
    links = [RobotLink(name, 0, np.eye(4)) for name in first]
    while links[-1:] and links[-1].name in following:
        element = following.pop(links[-1].name)
        origin, kind = links[-1].offset @ _origin(element), element.get("type")
        if kind == "revolute":
            axis = _numbers(_attribute(element, "axis", "xyz"))
            limits = (
                float(_attribute(element, "limit", name)) for name in ("lower", "upper", "velocity")
            )
            joints.append(
                Joint(element.get("name", ""), origin, axis / np.linalg.norm(axis), *limits)
            )
            origin = np.eye(4)
        elif kind != "fixed":
            raise ValueError(f"it has a {kind} joint")
        links.append(RobotLink(_attribute(element, "child", "link"), len(joints), origin))
    if len(first) != 1 or len(links) != len(elements) + 1:
        raise ValueError("its joints are not one chain")
    return tuple(joints), tuple(links)


def _attribute(element: ElementTree.Element, child: str, name: str) -> str:
    """Return an attribute of an element's child; raise ValueError if there is none."""
    found = element.find(child)
    value = None if found is None else found.get(name)
    if value is None:
        raise ValueError(f"<{element.tag}> has no <{child}> with {name}")
    return value


def _numbers(text: str) -> np.ndarray:
    """Return numbers between blanks, (n,) float; raise ValueError for something else."""
    return np.array([float(word) for word in text.split()])


def _origin(element: ElementTree.Element) -> np.ndarray:
    """Return the pose (4, 4) float, m, of an origin: about x by roll, y by pitch, z by yaw."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    roll, pitch, yaw = transforms.rotations(np.diag(_numbers(origin.get("rpy", "0 0 0"))))
    return transforms.rigid(yaw @ pitch @ roll, _numbers(origin.get("xyz", "0 0 0")))
