"""The robot in the 3D view: one model for each link, under the poses that the link sends."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer.protocol import DeviceName
from rastrainer.slicer.polydata import trianglesPolyData, vtkArray
from rastrainer.slicer.scene import nodes
from rastrainer.slicer.scene.nodes import Role
from rastrainer.slicer.scene.robot_description import LinkMesh

_POSES = tuple(map(nodes.poseKind, DeviceName.LINK_TO_WORLD))


def _byRole(scene: Any, className: str) -> dict[str, Any]:
    """Return our nodes of a class by their roles, in one look at the scene."""
    found = reversed(nodes.nodesOfClass(scene, className))
    return {node.GetAttribute(nodes.ROLE_ATTRIBUTE): node for node in found}


def missingLinks(scene: Any) -> list[int]:
    links = _byRole(scene, nodes.MODEL)
    return [number for number, kind in enumerate(Role.LINKS) if kind.role not in links]


def addLink(scene: Any, number: int, mesh: LinkMesh) -> None:
    """Show a link of the robot, transformed by the node that the connection fills."""
    _POSES[number].make(scene)
    surface = trianglesPolyData(mesh.points, mesh.triangles, mesh.normals)
    surface.GetPointData().SetScalars(vtkArray(mesh.colors, nodes.COLORS))
    # Everything is set before the node is added, so that each view draws it once.
    kind = Role.LINKS[number]
    display = nodes.setValues(slicer.vtkMRMLModelDisplayNode(), **kind.look)
    scene.AddNode(display)
    node = nodes.setValues(slicer.vtkMRMLModelNode(), Name=kind.name, **kind.values)
    node.SetAttribute(nodes.ROLE_ATTRIBUTE, kind.role)
    node.SetAndObservePolyData(surface)
    node.SetAndObserveDisplayNodeID(display.GetID())
    scene.AddNode(node)


def placeRobot(scene: Any, worldTransform: Any | None) -> None:
    """Let the robot follow its poses, with World placed by `worldTransform`."""
    links, poses = _byRole(scene, nodes.MODEL), _byRole(scene, nodes.TRANSFORM)
    wanted = None if worldTransform is None else worldTransform.GetID()
    for link, kind in zip(Role.LINKS, _POSES, strict=True):
        node, pose = links.get(link.role), poses.get(kind.role)
        if pose is None:
            if node is None and kind.find(scene) is None:
                continue
            pose = kind.make(scene)
        if pose.GetTransformNodeID() != wanted:
            pose.SetAndObserveTransformNodeID(wanted)
        if node is not None and node.GetTransformNodeID() != pose.GetID():
            node.SetAndObserveTransformNodeID(pose.GetID())


def setRobotVisible(scene: Any, visible: bool) -> None:
    for node in filter(None, (link.find(scene) for link in Role.LINKS)):
        node.SetDisplayVisibility(visible)
