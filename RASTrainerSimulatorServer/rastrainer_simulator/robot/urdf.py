"""Read a URDF that may be hostile: sizes, structure and numbers are checked before use."""

from __future__ import annotations

import io
import math
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import yourdfpy

from rastrainer.errors import InputError
from rastrainer.files.reading import plain_xml, read_bytes

LARGEST_FILE = 4 * 2**20
FARTHEST = 100.0
_MOVABLE = ("revolute", "continuous")


def read_urdf(path: Path) -> yourdfpy.Robot:
    """Return the links and joints of a URDF whose tree and numbers have been checked.

    No mesh is opened. Raises InputError where the file cannot be read, is not plain XML, is not a
    tree of links, or holds unusable numbers.
    """
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
