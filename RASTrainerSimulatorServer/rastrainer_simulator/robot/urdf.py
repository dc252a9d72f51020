"""Read a URDF that may be hostile: sizes, structure and numbers are checked before use."""

from __future__ import annotations

import io
import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import yourdfpy

from rastrainer.errors import InputError

LARGEST_FILE = 4_000_000
MOST_ELEMENTS = 20_000
FARTHEST = 100.0
_MOVABLE = ("revolute", "continuous")


def read_urdf(path: Path) -> yourdfpy.Robot:
    """Return the links and joints of a URDF whose tree and numbers have been checked.

    No mesh is opened. Raises InputError where the file cannot be read, declares a document type
    (entities could expand without end), is not a tree of links, or holds unusable numbers.
    """
    data = _read_bytes(path)
    _check_markup(data, path)
    try:
        robot = yourdfpy.URDF.load(
            io.BytesIO(data), build_scene_graph=False, load_meshes=False
        ).robot
    except Exception as error:  # a hostile file can break the parser in any way
        raise InputError(
            f"{path} is not a usable URDF: an element lacks a name, a parent, a child or a number "
            f"({type(error).__name__}: {error})."
        ) from error
    _check_tree(robot, path)
    for joint in robot.joints:
        _check_joint(joint, path)
    return robot


def _read_bytes(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            data = file.read(LARGEST_FILE + 1)
    except OSError as error:
        raise InputError(f"The URDF {path} cannot be read: {error.strerror}.") from error
    if len(data) > LARGEST_FILE:
        raise InputError(f"The URDF {path} is larger than {LARGEST_FILE // 1_000_000} MB.")
    return data


def _check_markup(data: bytes, path: Path) -> None:
    # Only UTF-8 passes, so the words below cannot hide behind another encoding.
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as error:
        raise InputError(f"The URDF {path} is not UTF-8 text.") from error
    if "\0" in text or "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise InputError(f"The URDF {path} declares a document type or entities; remove them.")
    try:
        root = ElementTree.fromstring(text.partition("?>")[2] if text.startswith("<?") else text)
    except ElementTree.ParseError as error:
        raise InputError(f"The URDF {path} is not well-formed XML: {error}.") from error
    if root.tag != "robot":
        raise InputError(f"The URDF {path} starts with <{root.tag}>; it should start with <robot>.")
    if sum(1 for _ in root.iter()) > MOST_ELEMENTS:
        raise InputError(f"The URDF {path} has more than {MOST_ELEMENTS} elements.")


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
