"""Write the URDF of the iiwa 7 with its pointer tool."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree import ElementTree

from iiwa7_dimensions import (
    COLORS,
    FLANGE_OFFSET,
    JOINTS,
    LINK_NAMES,
    TOOL_LENGTH,
    TOOL_LINK,
    TOOL_TIP_LINK,
)

HEADER = "<!-- KUKA LBR iiwa 7 R800 with a pointer tool. Written by make_iiwa7.py: do not edit. -->"


@dataclass(frozen=True)
class LinkBody:
    """The parts of a link: mesh files (relative to the URDF), mass and its distribution.

    `visuals` pairs a mesh file with a color's name. `center_of_mass` is in meters in the link's
    frame; `inertia` is (xx, xy, xz, yy, yz, zz) in kg·m² about the center of mass.
    """

    visuals: Sequence[tuple[str, str]]
    collision: str
    mass: float
    center_of_mass: Sequence[float]
    inertia: Sequence[float]


def urdf_text(bodies: Mapping[str, LinkBody], tip: tuple[str, str]) -> str:
    """Return the URDF as text.

    `bodies` holds one entry for every name in `LINK_NAMES`; `tip` is the mesh file and the color of
    the tool's tip.
    """
    robot = ElementTree.Element("robot", name="iiwa7")
    for name, color in COLORS.items():
        material = ElementTree.SubElement(robot, "material", name=name)
        ElementTree.SubElement(material, "color", rgba=_numbers(color))
    for name in LINK_NAMES:
        link, body = ElementTree.SubElement(robot, "link", name=name), bodies[name]
        inertial = ElementTree.SubElement(link, "inertial")
        ElementTree.SubElement(inertial, "origin", xyz=_numbers(body.center_of_mass), rpy="0 0 0")
        ElementTree.SubElement(inertial, "mass", value=_number(body.mass))
        moments = zip(("ixx", "ixy", "ixz", "iyy", "iyz", "izz"), body.inertia, strict=True)
        ElementTree.SubElement(inertial, "inertia", {key: _number(at) for key, at in moments})
        for file, color in body.visuals:
            _add_visual(link, file, color)
        _add_mesh(ElementTree.SubElement(link, "collision"), body.collision)
    _add_visual(ElementTree.SubElement(robot, "link", name=TOOL_TIP_LINK), *tip)
    for joint, parent, child in zip(JOINTS, LINK_NAMES[:7], LINK_NAMES[1:8], strict=True):
        element = _add_joint(robot, joint.name, "revolute", parent, child, joint.origin)
        ElementTree.SubElement(element, "axis", xyz=_numbers(joint.axis))
        ElementTree.SubElement(
            element,
            "limit",
            lower=repr(-math.radians(joint.limit_deg)),
            upper=repr(math.radians(joint.limit_deg)),
            velocity=repr(math.radians(joint.speed_deg_s)),
            effort=_number(joint.torque_nm),
        )
    for name, parent, child, height in (
        ("iiwa_joint_tool", LINK_NAMES[7], TOOL_LINK, FLANGE_OFFSET),
        ("iiwa_joint_tool_tip", TOOL_LINK, TOOL_TIP_LINK, TOOL_LENGTH),
    ):
        _add_joint(robot, name, "fixed", parent, child, (0.0, 0.0, height))
    ElementTree.indent(robot)
    text = ElementTree.tostring(robot, encoding="unicode")
    return f'<?xml version="1.0"?>\n{HEADER}\n{text}\n'


def _add_visual(link: ElementTree.Element, file: str, color: str) -> None:
    visual = ElementTree.SubElement(link, "visual")
    _add_mesh(visual, file)
    ElementTree.SubElement(visual, "material", name=color)


def _add_mesh(parent: ElementTree.Element, file: str) -> None:
    ElementTree.SubElement(parent, "origin", xyz="0 0 0", rpy="0 0 0")
    geometry = ElementTree.SubElement(parent, "geometry")
    ElementTree.SubElement(geometry, "mesh", filename=file)


def _add_joint(
    robot: ElementTree.Element,
    name: str,
    kind: str,
    parent: str,
    child: str,
    origin: Sequence[float],
) -> ElementTree.Element:
    joint = ElementTree.SubElement(robot, "joint", name=name, type=kind)
    ElementTree.SubElement(joint, "parent", link=parent)
    ElementTree.SubElement(joint, "child", link=child)
    ElementTree.SubElement(joint, "origin", xyz=_numbers(origin), rpy="0 0 0")
    return joint


def _numbers(values: Sequence[float]) -> str:
    return " ".join(_number(value) for value in values)


def _number(value: float) -> str:
    return f"{value:.7g}"
