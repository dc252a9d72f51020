"""The robot as its URDF describes it: the poses of its tool, and the surfaces of its links."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
import vtk

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.urdf import MeshPart, read_urdf
from rastrainer.protocol import DeviceName
from rastrainer.slicer.polydata import vtkArray
from rastrainer.transforms import MM_PER_M
from rastrainer.work_progress import Progress, no_progress

URDF = "iiwa7.urdf"
OTHER_ROBOT = "The trial was recorded with another robot than the one that is here."


def toolPoses(urdf: Path, q: np.ndarray) -> np.ndarray:
    """Return the poses (m, 4, 4) float, mm, of the tool at joint angles q (m, n) float, rad."""
    robot = read_urdf(urdf)
    if len(robot.joints) != q.shape[1]:
        raise InputError(OTHER_ROBOT)
    poses = np.broadcast_to(np.eye(4), (len(q), 4, 4))
    for joint, angles in zip(robot.joints, q.T, strict=True):
        turns = np.tile(np.eye(4), (len(q), 1, 1))
        turns[:, :3, :3] = transforms.rotations(angles[:, None] * joint.axis)
        poses = poses @ joint.origin @ turns
    poses = poses @ robot.links[-1].offset
    poses[:, :3, 3] *= MM_PER_M
    return poses


class LinkMesh(NamedTuple):
    """The surface of a link, mm: (n, 3) float32, with RGB as uint8; triangles (m, 3) int64."""

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

    robot = read_urdf(folder / URDF)
    links = {link.name: link for link in robot.links}
    meshes: list[LinkMesh] = []
    for number in range(len(DeviceName.LINK_TO_WORLD)):
        progress("", number / len(DeviceName.LINK_TO_WORLD))
        append = vtk.vtkAppendPolyData()
        for part in robot.meshes:
            if links[part.link].joint == number:
                append.AddInputData(_surface(part, links[part.link].offset @ part.origin))
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


def _surface(part: MeshPart, pose: np.ndarray) -> vtk.vtkPolyData:
    """Return a mesh in its link's frame, mm, with its normals, and its color at each point.

    `pose` (4, 4) float, m, is the pose of the mesh.
    """
    if not part.path.is_file():
        raise InputError(f"The robot's mesh {part.path} is missing.")
    reader, transform = vtk.vtkSTLReader(), vtk.vtkTransform()
    reader.SetFileName(str(part.path))
    transform.Scale(MM_PER_M, MM_PER_M, MM_PER_M)
    transform.Concatenate(pose.ravel())
    placed = vtk.vtkTransformPolyDataFilter()
    placed.SetInputConnection(reader.GetOutputPort())
    placed.SetTransform(transform)
    normals = vtk.vtkPolyDataNormals()
    normals.SetInputConnection(placed.GetOutputPort())
    normals.SetFeatureAngle(40.0)
    normals.Update()
    surface = normals.GetOutput()
    color = np.round(255 * np.array(part.color[:3])).astype(np.uint8)
    colors = np.tile(color, (surface.GetNumberOfPoints(), 1))
    surface.GetPointData().SetScalars(vtkArray(colors, "color"))
    return surface
