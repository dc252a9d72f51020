"""The robot as its URDF describes it: its chain of joints, and the meshes of its links."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.reading import plain_xml, read_bytes
from rastrainer.protocol import DeviceName
from rastrainer.transforms import MM_PER_M
from rastrainer.work_progress import Progress, no_progress

Element = ElementTree.Element
MAX_BYTES = 4 << 20


def readUrdf(path: Path) -> Element:
    content = plain_xml(read_bytes(path, MAX_BYTES), f"The URDF {path}")
    try:
        return ElementTree.fromstring(content)
    except ElementTree.ParseError as error:
        raise InputError(f"The URDF {path} is not well-formed XML: {error}.") from None


def attribute(element: Element, child: str, name: str) -> str:
    """Return an attribute of an element's child; raise ValueError if there is none."""
    found = element.find(child)
    value = None if found is None else found.get(name)
    if value is None:
        raise ValueError(f"<{element.tag}> has no <{child}> with {name}")
    return value


def numbers(text: str) -> np.ndarray:
    """Return numbers between blanks, (n,) float; raise ValueError for something else."""
    return np.array([float(word) for word in text.split()])


def originOf(element: Element) -> np.ndarray:
    """Return the pose (4, 4) float, mm, of an origin: about x by roll, y by pitch, z by yaw."""
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
    """Read the chain of a robot without branches."""
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
            axis = np.zeros(3)
            if joint.get("type") == "revolute":
                axis = numbers(attribute(joint, "axis", "xyz"))
                axis /= np.linalg.norm(axis)
            elif joint.get("type") != "fixed":
                raise ValueError
            axes.append(axis)
            link = attribute(joint, "child", "link")
    except ValueError:
        raise InputError(f"The URDF {urdf} is not a chain of revolute and fixed joints.") from None
    return ArmChain(np.array(origins), np.array(axes))


URDF = "iiwa7.urdf"


class Shell(NamedTuple):
    """One colored mesh of a link: `pose` (4, 4) float, mm, from the mesh to the link."""

    path: Path
    color: np.ndarray
    pose: np.ndarray


class LinkMesh(NamedTuple):
    """The surface of a link, in mm.

    Attributes:
        points: (n, 3) float32.
        normals: (n, 3) float32, unit.
        colors: (n, 3) uint8, RGB.
        triangles: (m, 3) int64, rows of the points.
    """

    points: np.ndarray
    normals: np.ndarray
    colors: np.ndarray
    triangles: np.ndarray


READ_LINKS = "rastrainer.slicer.scene.robot_description:readLinkMeshes"


def readLinkMeshes(folder: Path, progress: Progress = no_progress) -> tuple[LinkMesh, ...]:
    """Return the surfaces of links 0 to 7 of the robot in a folder.

    VTK's filters take half a second: `READ_LINKS` names this for a separate process.
    """
    root = readUrdf(folder / URDF)
    try:
        shells = _shells(root, folder)
    except (KeyError, ValueError) as error:
        raise InputError(f"The URDF {folder / URDF} cannot be used: {error}.") from None
    meshes: list[LinkMesh] = []
    for ofLink in shells:
        progress("", len(meshes) / len(shells))
        parts, first = [], 0
        for shell in ofLink:
            points, normals, triangles = _smooth(shell)
            colors = np.broadcast_to(np.round(255 * shell.color).astype(np.uint8), points.shape)
            parts.append((points, normals, colors, triangles + first))
            first += len(points)
        meshes.append(LinkMesh(*(np.concatenate(arrays) for arrays in zip(*parts, strict=True))))
    return tuple(meshes)


def _shells(root: Element, folder: Path) -> list[list[Shell]]:
    """Return the visual meshes of links 0 to 7; what is fixed to a link belongs to it."""
    colors = {
        material.get("name"): numbers(attribute(material, "color", "rgba"))[:3]
        for material in root.findall("material")
    }
    fixed = {
        attribute(joint, "child", "link"): (attribute(joint, "parent", "link"), originOf(joint))
        for joint in root.findall("joint")
        if joint.get("type") == "fixed"
    }
    shells: list[list[Shell]] = [[] for _ in DeviceName.LINK_TO_WORLD]
    for link in root.findall("link"):
        owner, pose = link.get("name", ""), np.eye(4)
        while owner in fixed:
            parent, toParent = fixed[owner]
            owner, pose = parent, toParent @ pose
        if not owner[-1:].isdecimal() or int(owner[-1]) >= len(shells):
            continue
        for visual in link.findall("visual"):
            material = visual.find("material")
            if material is not None and visual.find("geometry/mesh") is not None:
                path = folder / attribute(visual, "geometry/mesh", "filename")
                color = colors[material.get("name")]
                shells[int(owner[-1])].append(Shell(path, color, pose @ originOf(visual)))
    return shells


def _smooth(shell: Shell) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the points, normals and triangles of a mesh in its link's frame, mm."""
    import vtk
    from vtk.util.numpy_support import vtk_to_numpy

    if not shell.path.is_file():
        raise InputError(f"The robot's mesh {shell.path} is missing.")
    reader = vtk.vtkSTLReader()
    reader.SetFileName(str(shell.path))
    transform = vtk.vtkTransform()
    transform.Concatenate(shell.pose.ravel())
    transform.Scale(MM_PER_M, MM_PER_M, MM_PER_M)
    placed = vtk.vtkTransformPolyDataFilter()
    placed.SetInputConnection(reader.GetOutputPort())
    placed.SetTransform(transform)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(placed.GetOutputPort())
    normals.SetFeatureAngle(40.0)
    normals.Update()
    data = normals.GetOutput()
    return (
        vtk_to_numpy(data.GetPoints().GetData()),
        vtk_to_numpy(data.GetPointData().GetNormals()),
        vtk_to_numpy(data.GetPolys().GetConnectivityArray()).reshape(-1, 3),
    )
