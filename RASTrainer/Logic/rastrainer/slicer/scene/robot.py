"""The robot in the 3D view: one model for each link, under the poses that the link sends."""

from __future__ import annotations

from typing import Any

import slicer
import vtk

from rastrainer.protocol import DeviceName
from rastrainer.slicer.polydata import trianglesPolyData, vtkArray
from rastrainer.slicer.scene.nodes import (
    MODEL,
    ROLE_ATTRIBUTE,
    TRANSFORM,
    Role,
    findNode,
    poseNode,
    setValues,
)
from rastrainer.slicer.scene.robot_description import LinkMesh

COLORS = "color"


def missingLinks(scene: Any) -> list[int]:
    return [n for n in range(len(DeviceName.LINK_TO_WORLD)) if robotNode(scene, n) is None]


def addLink(scene: Any, number: int, mesh: LinkMesh) -> None:
    """Show a link of the robot, transformed by the node that the connection fills."""
    poseNode(scene, DeviceName.LINK_TO_WORLD[number])
    # Everything is set before the node is added, so each view draws it once. It is rebuilt from
    # the module's files, so a saved scene need not contain it.
    display = setValues(slicer.vtkMRMLModelDisplayNode(), SaveWithScene=False)
    display.SetActiveScalar(COLORS, vtk.vtkAssignAttribute.POINT_DATA)
    setValues(display, ScalarRangeFlag=display.UseDirectMapping, ScalarVisibility=True)
    scene.AddNode(display)
    node = setValues(slicer.vtkMRMLModelNode(), Name=f"Robot link {number}", SaveWithScene=False)
    node.SetAttribute(ROLE_ATTRIBUTE, f"{Role.ROBOT} link {number}")
    node.SetSelectable(False)
    surface = trianglesPolyData(mesh.points, mesh.triangles, mesh.normals)
    surface.GetPointData().SetScalars(vtkArray(mesh.colors, COLORS))
    node.SetAndObservePolyData(surface)
    node.SetAndObserveDisplayNodeID(display.GetID())
    scene.AddNode(node)


def placeRobot(scene: Any, worldTransform: Any | None) -> None:
    """Let the robot follow its poses, with World placed by `worldTransform`."""
    for number, device in enumerate(DeviceName.LINK_TO_WORLD):
        pose = scene.GetFirstNode(device, TRANSFORM)
        node = robotNode(scene, number)
        if pose is None and node is None:
            continue
        pose = pose or poseNode(scene, device)
        wanted = None if worldTransform is None else worldTransform.GetID()
        if pose.GetTransformNodeID() != wanted:
            pose.SetAndObserveTransformNodeID(wanted)
        if node is not None and node.GetTransformNodeID() != pose.GetID():
            node.SetAndObserveTransformNodeID(pose.GetID())


def setRobotVisible(scene: Any, visible: bool) -> None:
    for number in range(len(DeviceName.LINK_TO_WORLD)):
        node = robotNode(scene, number)
        if node is not None and node.GetDisplayNode() is not None:
            node.GetDisplayNode().SetVisibility(visible)


def robotNode(scene: Any, number: int) -> Any | None:
    """Return the model of a link, 0 to 7, or None; the tool belongs to link 7."""
    return findNode(scene, MODEL, f"{Role.ROBOT} link {number}")
