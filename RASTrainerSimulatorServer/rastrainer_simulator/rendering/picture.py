"""Render the robot at the head, in its room, at one moment; and a scenario's preview."""

from __future__ import annotations

from collections.abc import Generator, Iterable, Mapping, Sequence
from pathlib import Path

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the renderer)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (
    vtkActor,
    vtkPolyDataMapper,
    vtkRenderer,
    vtkRenderWindow,
    vtkWindowToImageFilter,
)

from rastrainer import transforms
from rastrainer.files.writing import write_bytes
from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import Proximity
from rastrainer.scenario.scenario import Camera, Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.collision import stand_pose
from rastrainer_simulator.core.arm import start_joints
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.rendering.lighting import Shadows, light_room
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import RobotModel, load_robot
from rastrainer_simulator.scene.nodes import (
    NEXT,
    TIP_FREE,
    TIP_MARKER,
    TIP_NEAR,
    TOOL,
    TOUCHED,
    Material,
    Node,
    Surface,
    link_node_name,
)
from rastrainer_simulator.scene.scene_glb import scene_nodes
from rastrainer_simulator.scene.surfaces import surface, vtk_matrix


def frames(
    renderer: vtkRenderer, shots: Iterable[tuple[Camera, tuple[int, int]]]
) -> Generator[np.ndarray]:
    """Yield a renderer's pictures, made in memory, one for each camera and size (width, height).

    They are (height, width, 3) uint8, the top row first. `shots` may change the scene before each
    picture. The graphics resources are freed after the last one.
    """
    window = vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(0)
    window.AddRenderer(renderer)
    # VTK warns that there is no display: none is needed. Errors are still shown.
    before = vtkLogger.GetCurrentVerbosityCutoff()
    try:
        for camera, size in shots:
            vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
            window.SetSize(*size)
            # The scenario's cameras are in mm, the scene in meters.
            view = renderer.GetActiveCamera()
            view.SetPosition(*(camera.position_mm / MM_PER_M))
            view.SetFocalPoint(*(camera.focal_point_mm / MM_PER_M))
            view.SetViewUp(*camera.view_up)
            view.SetViewAngle(camera.view_angle_deg)
            renderer.ResetCameraClippingRange()
            window.Render()
            shot = vtkWindowToImageFilter()
            shot.SetInput(window)
            shot.ReadFrontBufferOff()
            shot.ShouldRerenderOff()
            shot.Update()
            vtkLogger.SetStderrVerbosity(before)
            pixels = vtk_to_numpy(shot.GetOutput().GetPointData().GetScalars())
            yield pixels.reshape(size[1], size[0], 3)[::-1].copy()
    finally:
        vtkLogger.SetStderrVerbosity(before)
        window.Finalize()


def write_png(pixels: np.ndarray, path: Path) -> None:
    """Write (height, width, 3) uint8 pixels, whole or not at all, in place of an older picture."""
    height, width, _ = pixels.shape
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(pixels[::-1].reshape(-1, 3), deep=True))
    writer = vtkPNGWriter()
    writer.SetInputData(image)
    writer.WriteToMemoryOn()
    writer.Write()
    write_bytes(path, vtk_to_numpy(writer.GetResult()).tobytes())


def posed(
    robot: RobotModel, q: Sequence[float], head_to_world: np.ndarray, head: HeadMesh
) -> dict[str, np.ndarray]:
    """Return the poses of the moving nodes in World, m, for joint angles `q`, rad.

    `head_to_world` is (4, 4) float, mm, from the MRI's RAS to World.
    """
    links = make_kinematics(robot).links(tuple(q))
    pose = transforms.in_meters(head_to_world)
    poses = {link_node_name(link.joint): links[link.name] for link in robot.moving_links}
    stand = stand_pose(pose, head.base / MM_PER_M)
    return {**poses, TOOL: links[robot.tip.name], "head": pose, "stand": stand}


def looks_of(
    touched: Iterable[str], next_point: str | None = None, proximity: Proximity = Proximity.FREE
) -> dict[str, Material]:
    """Return the materials of fiducials and tip, which is light blue near and on the head."""
    looks = {f"fiducial_{label}": TOUCHED for label in touched}
    if next_point is not None:
        looks[f"fiducial_{next_point}"] = NEXT
    looks[TIP_MARKER] = TIP_FREE if proximity is Proximity.FREE else TIP_NEAR
    return looks


def node_actors(
    nodes: Sequence[Node], poses: Mapping[str, np.ndarray], looks: Mapping[str, Material]
) -> list[vtkActor]:
    """Return the actors of nodes in World.

    `poses` has a (4, 4) float pose in World, m, by the name of each node that is moved; `looks` a
    material by the name of each node that has another color than in the scene.
    """
    actors = []
    for node in nodes:
        pose = poses.get(node.name, np.eye(4))
        for part in node.walk():
            for shape in () if part.is_hidden else part.surfaces:
                actors.append(_actor(shape, looks.get(part.name, shape.material), pose))
    return actors


def _actor(shape: Surface, material: Material, pose: np.ndarray) -> vtkActor:
    mapper = vtkPolyDataMapper()
    mapper.SetInputData(surface(shape.vertices, shape.triangles, shape.normals))
    mapper.ScalarVisibilityOff()
    made = vtkActor()
    made.SetMapper(mapper)
    made.SetUserMatrix(vtk_matrix(pose))
    target = made.GetProperty()
    target.SetOpacity(material.opacity)
    if material.glowing:
        # Shadows need a lit material: switching its lighting off breaks their shader.
        target.SetColor(*material.color)
        target.SetAmbient(1.0)
        target.SetDiffuse(0.0)
    else:
        target.SetInterpolationToPBR()
        target.SetColor(*material.linear_color)
        target.SetRoughness(material.roughness)
        target.SetMetallic(material.metallic)
    return made


INSET_SHARE = 0.31
FRAME_SHARE = 0.006


def render_picture(
    path: Path,
    nodes: Sequence[Node],
    poses: Mapping[str, np.ndarray],
    looks: Mapping[str, Material],
    camera: Camera,
    inset: Camera | None = None,
    size: tuple[int, int] = (1600, 900),
    shadows: Shadows = Shadows.FULL,
) -> None:
    """Write a PNG of a scene at one moment, in place of an older one.

    `nodes`, `poses` and `looks` are as of `node_actors`; the cameras are a scenario's; `inset` is
    a second view in the upper right corner; `size` is the picture's width and height in pixels.
    Software rendering takes some seconds, half as many with small shadows.
    """
    renderer = vtkRenderer()
    for actor in node_actors(nodes, poses, looks):
        renderer.AddActor(actor)
    light_room(renderer, shadows)
    shots = [(camera, size)]
    if inset:
        width, height = (round(INSET_SHARE * length) for length in size)
        shots.append((inset, (width, height)))
    pixels, *corner = frames(renderer, shots)
    for picture in corner:
        lay_in_corner(pixels, picture)
    write_png(pixels, path)


def lay_in_corner(pixels: np.ndarray, inset: np.ndarray) -> None:
    """Lay a framed inset over the upper right corner; both (height, width, 3) uint8."""
    frame = max(1, round(FRAME_SHARE * pixels.shape[0]))
    margin = 3 * frame
    height, width = inset.shape[:2]
    left = pixels.shape[1] - margin - width - 2 * frame
    pixels[margin : margin + height + 2 * frame, left : left + width + 2 * frame] = 255
    top, left = margin + frame, left + frame
    pixels[top : top + height, left : left + width] = inset


SIZE = (640, 480)


def draw_preview(path: Path, scenario: Scenario, head: HeadMesh) -> None:
    """Draw the head as a trainee first sees it, with the first task if there is one."""
    robot = load_robot()
    q = start_joints(robot, scenario, SimulationSettings().start_height)
    poses = posed(robot, q, scenario.head_to_world, head)
    task = scenario.tasks[0] if scenario.tasks else None
    nodes = scene_nodes(scenario, robot, head, task)
    camera = scenario.cameras["close-up"]
    render_picture(path, nodes, poses, looks_of(()), camera, size=SIZE, shadows=Shadows.SMALL)
