"""The robot in the 3D view: one model for each link, under the poses that the link sends."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.protocol import DeviceName
from rastrainer.slicer.polydata import trianglesPolyData, vtkArray
from rastrainer.slicer.scene.nodes import COLORS, ROLE_ATTRIBUTE, Role, poseKind, setValues
from rastrainer.slicer.scene.robot_description import LinkMesh


def missingLinks(scene: Any) -> list[int]:
    return [number for number, kind in enumerate(Role.LINKS) if kind.find(scene) is None]


def addLink(scene: Any, number: int, mesh: LinkMesh) -> None:
    """Show a link of the robot, transformed by the node that the connection fills."""
    poseKind(DeviceName.LINK_TO_WORLD[number]).make(scene)
    surface = trianglesPolyData(mesh.points, mesh.triangles, mesh.normals)
    surface.GetPointData().SetScalars(vtkArray(mesh.colors, COLORS))
    # Everything is set before the node is added, so that each view draws it once.
    kind = Role.LINKS[number]
    display = setValues(slicer.vtkMRMLModelDisplayNode(), **kind.look)
    scene.AddNode(display)
    node = setValues(slicer.vtkMRMLModelNode(), Name=kind.name, **kind.values)
    node.SetAttribute(ROLE_ATTRIBUTE, kind.role)
    node.SetAndObservePolyData(surface)
    node.SetAndObserveDisplayNodeID(display.GetID())
    scene.AddNode(node)


def placeRobot(scene: Any, worldTransform: Any | None) -> None:
    """Let the robot follow its poses, with World placed by `worldTransform`."""
    for link, device in zip(Role.LINKS, DeviceName.LINK_TO_WORLD, strict=True):
        node, kind = link.find(scene), poseKind(device)
        if node is None and kind.find(scene) is None:
            continue
        pose = kind.make(scene)
        wanted = None if worldTransform is None else worldTransform.GetID()
        if pose.GetTransformNodeID() != wanted:
            pose.SetAndObserveTransformNodeID(wanted)
        if node is not None and node.GetTransformNodeID() != pose.GetID():
            node.SetAndObserveTransformNodeID(pose.GetID())


def setRobotVisible(scene: Any, visible: bool) -> None:
    for node in filter(None, (link.find(scene) for link in Role.LINKS)):
        node.SetDisplayVisibility(visible)
