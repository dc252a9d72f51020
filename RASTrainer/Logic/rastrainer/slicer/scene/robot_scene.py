"""The robot in the 3D view: its meshes under the link poses that the simulator sends."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.protocol import DeviceName
from rastrainer.slicer.scene.link_nodes import prepareNodes
from rastrainer.slicer.scene.scene import ROLE_ATTRIBUTE, Role, findNode
from rastrainer.slicer.scene.urdf import Element, attribute, numbers, originOf, readUrdf
from rastrainer.transforms import MM_PER_M

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
