"""The robot as its URDF describes it: its chain of joints, and the meshes of its links."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import NamedTuple

import numpy as np
import vtk

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.reading import plain_xml, read_bytes
from rastrainer.protocol import DeviceName
from rastrainer.slicer.polydata import vtkArray
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
    from scipy.spatial.transform import Rotation

    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    xyz = numbers(origin.get("xyz", "0 0 0"))
    turn = Rotation.from_euler("xyz", numbers(origin.get("rpy", "0 0 0")))
    return transforms.rigid(turn.as_matrix(), MM_PER_M * xyz)


OTHER_ROBOT = "The trial was recorded with another robot than the one that is here."


def toolPoses(urdf: Path, q: np.ndarray) -> np.ndarray:
    """Return the poses (m, 4, 4) float, mm, of the tool at joint angles q (m, n) float, rad.

    The joints are a chain from the robot's base to the tip of its tool.
    """
    from scipy.spatial.transform import Rotation

    joints = readUrdf(urdf).findall("joint")
    types = [joint.get("type") for joint in joints]
    isArm = {*types} <= {"revolute", "fixed"}
    if isArm and types.count("revolute") != q.shape[1]:
        raise InputError(OTHER_ROBOT)
    poses, angles = np.broadcast_to(np.eye(4), (len(q), 4, 4)), iter(q.T)
    try:
        following = {attribute(joint, "parent", "link"): joint for joint in joints}
        (link,) = following.keys() - {attribute(joint, "child", "link") for joint in joints}
        if len(following) != len(joints) or not isArm:
            raise ValueError
        while link in following:
            joint = following.pop(link)
            poses = poses @ originOf(joint)
            if joint.get("type") == "revolute":
                axis = numbers(attribute(joint, "axis", "xyz"))
                turns = next(angles)[:, None] * axis / np.linalg.norm(axis)
                turn = np.broadcast_to(np.eye(4), poses.shape).copy()
                turn[:, :3, :3] = Rotation.from_rotvec(turns).as_matrix()
                poses = poses @ turn
            link = attribute(joint, "child", "link")
    except ValueError:
        raise InputError(f"The URDF {urdf} is not a chain of revolute and fixed joints.") from None
    return poses


URDF = "iiwa7.urdf"


Shell = tuple[Path, np.ndarray, np.ndarray]
"""Mesh of a link, its color, and its pose (4, 4) float, mm, in the frame of the link."""


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
    from vtk.util.numpy_support import vtk_to_numpy

    root = readUrdf(folder / URDF)
    try:
        shells = _shells(root, folder)
    except (KeyError, ValueError) as error:
        raise InputError(f"The URDF {folder / URDF} cannot be used: {error}.") from None
    meshes: list[LinkMesh] = []
    for ofLink in shells:
        progress("", len(meshes) / len(shells))
        append = vtk.vtkAppendPolyData()
        for shell in ofLink:
            append.AddInputData(_surface(*shell))
        append.Update()
        data = append.GetOutput()
        arrays = (
            data.GetPoints().GetData(),
            data.GetPointData().GetNormals(),
            data.GetPointData().GetScalars(),
            data.GetPolys().GetConnectivityArray(),
        )
        points, normals, colors, triangles = map(vtk_to_numpy, arrays)
        meshes.append(LinkMesh(points, normals, colors, triangles.reshape(-1, 3)))
    return tuple(meshes)


def _shells(root: Element, folder: Path) -> list[list[Shell]]:
    """Return the visual meshes of links 0 to 7, with all parts that are fixed to them."""
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
                shells[int(owner[-1])].append((path, color, pose @ originOf(visual)))
    return shells


def _surface(path: Path, color: np.ndarray, pose: np.ndarray) -> vtk.vtkPolyData:
    """Return a mesh in its link's frame, mm, with its normals, and its color at each point."""
    if not path.is_file():
        raise InputError(f"The robot's mesh {path} is missing.")
    reader = vtk.vtkSTLReader()
    reader.SetFileName(str(path))
    transform = vtk.vtkTransform()
    transform.Concatenate(pose.ravel())
    transform.Scale(MM_PER_M, MM_PER_M, MM_PER_M)
    placed = vtk.vtkTransformPolyDataFilter()
    placed.SetInputConnection(reader.GetOutputPort())
    placed.SetTransform(transform)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(placed.GetOutputPort())
    normals.SetFeatureAngle(40.0)
    normals.Update()
    surface = normals.GetOutput()
    colors = np.tile(np.round(255 * color).astype(np.uint8), (surface.GetNumberOfPoints(), 1))
    surface.GetPointData().SetScalars(vtkArray(colors, "color"))
    return surface
