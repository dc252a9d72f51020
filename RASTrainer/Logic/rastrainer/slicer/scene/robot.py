"""The robot: its URDF, its meshes in the 3D view under the poses of the link, and its arm."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import slicer
import vtk

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.reading import plain_xml, read_bytes
from rastrainer.protocol import DeviceName
from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, Role, findNode, prepareNodes
from rastrainer.transforms import MM_PER_M

Element = ElementTree.Element
MAX_BYTES = 4 << 20


def readUrdf(path: Path) -> Element:
    """Return the root of a URDF file.

    Raises:
        InputError: the file is missing, too large or not well-formed.
    """
    content = plain_xml(read_bytes(path, MAX_BYTES), f"The URDF {path}")
    try:
        return ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise InputError(f"The URDF {path} is not well-formed XML: {error}.") from None


def attribute(element: Element, child: str, name: str) -> str:
    """Return an attribute of an element's child.

    Raises:
        ValueError: there is no such child, or it lacks the attribute.
    """
    found = element.find(child)
    value = None if found is None else found.get(name)
    if value is None:
        raise ValueError(f"<{element.tag}> has no <{child}> with {name}")
    return value


def numbers(text: str) -> np.ndarray:
    """Return numbers between blanks, (n,) float.

    Raises:
        ValueError: the text contains something else.
    """
    return np.array([float(word) for word in text.split()])


def originOf(element: Element) -> np.ndarray:
    """Return the pose (4, 4) float, mm, of an origin: about x by roll, y by pitch, z by yaw.

    Raises:
        ValueError: the origin is malformed.
    """
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    xyz = numbers(origin.get("xyz", "0 0 0"))
    roll, pitch, yaw = numbers(origin.get("rpy", "0 0 0"))
    (sr, sp, sy), (cr, cp, cy) = np.sin([roll, pitch, yaw]), np.cos([roll, pitch, yaw])
    rotation = np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )
    return transforms.rigid(rotation, MM_PER_M * xyz)


@dataclass(frozen=True, eq=False)
class ArmChain:
    """The joints from the robot's base to the tip of its tool, in their order.

    Attributes:
        origins: (n, 4, 4) float, of each joint in the frame of the one before, mm.
        axes: (n, 3) float, unit; zeros for a joint that does not move.
    """

    origins: np.ndarray
    axes: np.ndarray

    @property
    def moving(self) -> int:
        """How many joints move."""
        return int(self.axes.any(axis=1).sum())

    def toolToWorld(self, q: np.ndarray) -> np.ndarray:
        """Return the poses (m, 4, 4) float, mm, of the tool at joint angles q (m, n) float, rad.

        Rotations follow Rodrigues' formula R = I + sin a K + (1 − cos a) K².
        """
        poses = np.broadcast_to(np.eye(4), (len(q), 4, 4))
        column = 0
        for origin, axis in zip(self.origins, self.axes, strict=True):
            poses = poses @ origin
            if not axis.any():
                continue
            angles = q[:, column, None, None]
            column += 1
            x, y, z = axis
            cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
            turn = np.zeros((len(q), 4, 4))
            turn[:, 3, 3] = 1.0
            turn[:, :3, :3] = (
                np.eye(3) + np.sin(angles) * cross + (1.0 - np.cos(angles)) * (cross @ cross)
            )
            poses = poses @ turn
        return poses


def readArmChain(urdf: Path) -> ArmChain:
    """Read the chain of a robot without branches.

    Raises:
        InputError: the file cannot be used, or its joints are no chain of turning and fixed ones.
    """
    root = readUrdf(urdf)
    try:
        joints = {attribute(joint, "parent", "link"): joint for joint in root.findall("joint")}
        children = {attribute(joint, "child", "link") for joint in joints.values()}
        (base,) = joints.keys() - children
        if len(joints) != len(root.findall("joint")):
            raise ValueError
        origins, axes, link = [], [], base
        while link in joints:
            joint = joints.pop(link)
            origins.append(originOf(joint))
            axes.append(_axis(joint))
            link = attribute(joint, "child", "link")
    except ValueError:
        raise InputError(f"The URDF {urdf} is not a chain of revolute and fixed joints.") from None
    return ArmChain(np.array(origins), np.array(axes))


def _axis(joint: Element) -> np.ndarray:
    if joint.get("type") == "fixed":
        return np.zeros(3)
    if joint.get("type") != "revolute":
        raise ValueError
    axis = numbers(attribute(joint, "axis", "xyz"))
    return axis / np.linalg.norm(axis)


URDF = "iiwa7.urdf"


class Shell(NamedTuple):
    """One colored mesh of a link: `pose` (4, 4) float, mm, from the mesh to the link."""

    path: Path
    color: np.ndarray
    pose: np.ndarray


def showRobot(scene: Any, folder: Path) -> None:
    """Show the robot of a folder, one model a link; called again, nothing is made twice.

    The models are transformed by the nodes that the link fills (`Link0ToWorld` …). Links
    whose poses have not arrived yet are shown at the robot's base.

    Raises:
        InputError: the folder's URDF or a mesh cannot be used.
    """
    missing = [
        n for n, device in enumerate(DeviceName.LINK_TO_WORLD) if robotNode(scene, n) is None
    ]
    if not missing:
        return
    prepareNodes(scene)
    shells = _readShells(folder)
    surfaces = {number: _merged(shells[number]) for number in missing}
    for number, surface in surfaces.items():
        node = scene.AddNewNodeByClass("vtkMRMLModelNode", f"Robot link {number}")
        node.SetAttribute(ROLE_ATTRIBUTE, _role(number))
        node.SetAndObservePolyData(surface)
        # It is rebuilt from the module's files, so a saved scene need not contain it.
        node.SetSaveWithScene(False)
        node.SetSelectable(False)
        node.CreateDefaultDisplayNodes()
        display = node.GetDisplayNode()
        display.SetSaveWithScene(False)
        display.SetActiveScalar("color", vtk.vtkAssignAttribute.POINT_DATA)
        display.SetScalarRangeFlag(display.UseDirectMapping)
        display.SetScalarVisibility(True)


def placeRobot(scene: Any, worldTransform: Any | None) -> None:
    """Let the robot follow its poses, with World placed by `worldTransform`."""
    for number, device in enumerate(DeviceName.LINK_TO_WORLD):
        pose = scene.GetFirstNode(device, "vtkMRMLLinearTransformNode")
        node = robotNode(scene, number)
        if pose is None:
            continue
        wanted = None if worldTransform is None else worldTransform.GetID()
        if pose.GetTransformNodeID() != wanted:
            pose.SetAndObserveTransformNodeID(wanted)
        if node is not None and node.GetTransformNodeID() != pose.GetID():
            node.SetAndObserveTransformNodeID(pose.GetID())


def setRobotVisible(scene: Any, visible: bool) -> None:
    """Show or hide the robot, as far as it is in the scene."""
    for number in range(len(DeviceName.LINK_TO_WORLD)):
        node = robotNode(scene, number)
        if node is not None and node.GetDisplayNode() is not None:
            node.GetDisplayNode().SetVisibility(visible)


def robotNode(scene: Any, number: int) -> Any | None:
    """Return the model of a link, 0 to 7, or None; the tool belongs to link 7."""
    return findNode(scene, "vtkMRMLModelNode", _role(number))


def _role(number: int) -> str:
    return f"{Role.ROBOT} link {number}"


def _readShells(folder: Path) -> list[list[Shell]]:
    """Return the visual meshes of links 0 to 7; what is fixed to a link belongs to it."""
    root = readUrdf(folder / URDF)
    try:
        return _shellsOfLinks(root, folder)
    except (KeyError, ValueError) as error:
        raise InputError(f"The URDF {folder / URDF} cannot be used: {error}.") from None


def _shellsOfLinks(root: Element, folder: Path) -> list[list[Shell]]:
    colors = {
        material.get("name"): numbers(attribute(material, "color", "rgba"))[:3]
        for material in root.findall("material")
    }
    links = {link.get("name", ""): link for link in root.findall("link")}
    fixed = {
        attribute(joint, "child", "link"): (attribute(joint, "parent", "link"), originOf(joint))
        for joint in root.findall("joint")
        if joint.get("type") == "fixed"
    }
    shells: list[list[Shell]] = [[] for _ in DeviceName.LINK_TO_WORLD]
    for name, link in links.items():
        owner, pose = name, np.eye(4)
        while owner in fixed:
            parent, toParent = fixed[owner]
            owner, pose = parent, toParent @ pose
        if owner[-1:].isdecimal() and int(owner[-1]) < len(shells):
            shells[int(owner[-1])] += _shellsOf(link, folder, colors, pose)
    return shells


def _shellsOf(
    link: Element, folder: Path, colors: dict[str | None, np.ndarray], pose: np.ndarray
) -> Iterator[Shell]:
    for visual in link.findall("visual"):
        material = visual.find("material")
        if material is not None and visual.find("geometry/mesh") is not None:
            path = folder / attribute(visual, "geometry/mesh", "filename")
            yield Shell(path, colors[material.get("name")], pose @ originOf(visual))


def _merged(shells: list[Shell]) -> vtk.vtkPolyData:
    """Return the meshes of a link in mm, each with its color at its points."""
    append = vtk.vtkAppendPolyData()
    for shell in shells:
        if not shell.path.is_file():
            raise InputError(f"The robot's mesh {shell.path} is missing.")
        reader = vtk.vtkSTLReader()
        reader.SetFileName(str(shell.path))
        transform = vtk.vtkTransform()
        transform.Concatenate(slicer.util.vtkMatrixFromArray(shell.pose))
        transform.Scale(MM_PER_M, MM_PER_M, MM_PER_M)
        placed = vtk.vtkTransformPolyDataFilter()
        placed.SetInputConnection(reader.GetOutputPort())
        placed.SetTransform(transform)
        normals = vtk.vtkPolyDataNormals()
        normals.SetInputConnection(placed.GetOutputPort())
        normals.SetFeatureAngle(40.0)
        normals.Update()
        append.AddInputData(_colored(normals.GetOutput(), shell.color))
    append.Update()
    return append.GetOutput()


def _colored(data: vtk.vtkPolyData, color: np.ndarray) -> vtk.vtkPolyData:
    colors = vtk.vtkUnsignedCharArray()
    colors.SetName("color")
    colors.SetNumberOfComponents(3)
    colors.SetNumberOfTuples(data.GetNumberOfPoints())
    for component, value in enumerate(color):
        colors.FillComponent(component, round(255 * value))
    data.GetPointData().SetScalars(colors)
    return data
