"""The robot in the 3D view: one model for each link, under the poses that the link sends."""

from __future__ import annotations

from typing import Any

import slicer
import vtk

from rastrainer.protocol import DeviceName
from rastrainer.slicer.polydata import trianglesPolyData, vtkArray
from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, Role, poseKind, setValues
from rastrainer.slicer.scene.robot_description import LinkMesh

COLORS = "color"


def missingLinks(scene: Any) -> list[int]:
    return [number for number, kind in enumerate(Role.LINKS) if kind.find(scene) is None]


def addLink(scene: Any, number: int, mesh: LinkMesh) -> None:
    """Show a link of the robot, transformed by the node that the connection fills."""
    poseKind(DeviceName.LINK_TO_WORLD[number]).make(scene)
    # Everything is set before the node is added, so each view draws it once. It is rebuilt from
    # the module's files, so a saved scene need not contain it.
    display = setValues(slicer.vtkMRMLModelDisplayNode(), SaveWithScene=False)
    display.SetActiveScalar(COLORS, vtk.vtkAssignAttribute.POINT_DATA)
    setValues(display, ScalarRangeFlag=display.UseDirectMapping, ScalarVisibility=True)
    scene.AddNode(display)
    kind = Role.LINKS[number]
    node = setValues(slicer.vtkMRMLModelNode(), Name=kind.name, **kind.values)
    node.SetAttribute(ROLE_ATTRIBUTE, kind.role)
    surface = trianglesPolyData(mesh.points, mesh.triangles, mesh.normals)
    surface.GetPointData().SetScalars(vtkArray(mesh.colors, COLORS))
    node.SetAndObservePolyData(surface)
    node.SetAndObserveDisplayNodeID(display.GetID())
    scene.AddNode(node)


def placeRobot(scene: Any, worldTransform: Any | None) -> None:
    """Let the robot follow its poses, with World placed by `worldTransform`."""
    for link, device in zip(Role.LINKS, DeviceName.LINK_TO_WORLD, strict=True):
        poses, node = poseKind(device), link.find(scene)
        pose = scene.GetFirstNode(device, poses.className)
        if pose is None and node is None:
            continue
        pose = pose or poses.make(scene)
        wanted = None if worldTransform is None else worldTransform.GetID()
        if pose.GetTransformNodeID() != wanted:
            pose.SetAndObserveTransformNodeID(wanted)
        if node is not None and node.GetTransformNodeID() != pose.GetID():
            node.SetAndObserveTransformNodeID(pose.GetID())


def setRobotVisible(scene: Any, visible: bool) -> None:
    for node in filter(None, (link.find(scene) for link in Role.LINKS)):
        node.SetDisplayVisibility(visible)
