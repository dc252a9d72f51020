"""Picture the default scenario: for lists, and its six tasks from four sides.

python assets/scenarios/make_preview.py        writes colin27/preview.png and colin27-tasks.png
"""

import sys
from itertools import pairwise
from pathlib import Path

import numpy as np
import vtk
from scipy.spatial import geometric_slerp
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.head.mesh import HeadMesh, read_head_mesh
from rastrainer.scenario.points import Task
from rastrainer.scenario.scenario import PREVIEW_NAME, load_scenario
from rastrainer_simulator.rendering.picture import draw_preview
from rastrainer_simulator.scene.surfaces import surface

FOLDER = Path(__file__).parent / "colin27"
TILE = (300, 270)
VIEWS = {
    "front": (0.1, 1, 0.5),
    "right": (1, 0.1, 0.35),
    "left": (-1, 0.1, 0.35),
    "back": (0, -1, 0.4),
}
EYE_DISTANCE_MM, VIEW_ANGLE_DEG = 560.0, 24.0
BACKGROUND, SKIN = (0.96, 0.97, 0.98), (0.87, 0.72, 0.62)
BALL, WAY, TEXT = (0.1, 0.35, 0.9), (0.9, 0.45, 0.1), (0.05, 0.1, 0.35)


def main() -> int:
    scenario = load_scenario(FOLDER)
    mesh = read_head_mesh(scenario.head)
    window = vtk.vtkRenderWindow()
    window.OffScreenRenderingOn()
    window.SetMultiSamples(4)
    window.SetSize(TILE[0] * len(scenario.tasks), TILE[1] * len(VIEWS))
    skin = vtk.vtkPolyDataNormals()
    head = surface(mesh.vertices, mesh.triangles)
    head.GetPoints().SetData(numpy_to_vtk(mesh.vertices, deep=True))  # In double precision.
    skin.SetInputData(head)
    skin.SetFeatureAngle(60)
    for column, task in enumerate(scenario.tasks):
        for row, (view, direction) in enumerate(VIEWS.items()):
            renderer = _renderer(mesh, task, np.array(direction), skin)
            caption = vtk.vtkTextActor()
            caption.SetInput(f"{task.title}, {view}")
            caption.SetPosition(8, 8)
            _style(caption.GetTextProperty(), 13)
            renderer.AddViewProp(caption)
            left, top = column / len(scenario.tasks), 1 - row / len(VIEWS)
            renderer.SetViewport(left, top - 1 / len(VIEWS), left + 1 / len(scenario.tasks), top)
            window.AddRenderer(renderer)
    window.Render()
    picture = vtk.vtkWindowToImageFilter()
    picture.SetInput(window)
    picture.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetCompressionLevel(9)
    writer.SetInputConnection(picture.GetOutputPort())
    writer.SetFileName(str(FOLDER.parent / "colin27-tasks.png"))
    writer.Write()
    draw_preview(FOLDER / PREVIEW_NAME, scenario, mesh)
    return 0


def _renderer(
    mesh: HeadMesh, task: Task, direction: np.ndarray, skin: vtk.vtkPolyDataNormals
) -> vtk.vtkRenderer:
    center = mesh.centroid + np.array([0.0, 0.0, 10.0])
    eye = center + EYE_DISTANCE_MM * direction / np.linalg.norm(direction)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(BACKGROUND)
    renderer.AddActor(_actor(skin, SKIN))
    line, points, tube = vtk.vtkLineSource(), vtk.vtkPoints(), vtk.vtkTubeFilter()
    points.SetData(numpy_to_vtk(_way(mesh, task), deep=True))
    line.SetPoints(points)
    tube.SetInputConnection(line.GetOutputPort())
    tube.SetRadius(0.8)
    renderer.AddActor(_actor(tube, WAY))
    for label, point in zip(task.labels, task.fiducials, strict=True):
        ball = vtk.vtkSphereSource()
        ball.SetCenter(point)
        ball.SetRadius(2.6)
        ball.SetThetaResolution(16)
        ball.SetPhiResolution(16)
        renderer.AddActor(_actor(ball, BALL))
        number = vtk.vtkBillboardTextActor3D()
        number.SetInput(label)
        number.SetPosition(point + 9.0 * (eye - point) / np.linalg.norm(eye - point))
        number.SetDisplayOffset(4, 3)
        _style(number.GetTextProperty(), 15)
        renderer.AddActor(number)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(eye)
    camera.SetFocalPoint(center)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(VIEW_ANGLE_DEG)
    renderer.ResetCameraClippingRange()
    return renderer


def _way(mesh: HeadMesh, task: Task) -> np.ndarray:
    """Return points just above the skin from fiducial to fiducial, (n, 3) mm, to be drawn only."""
    center = mesh.centroid
    outward = mesh.vertices - center
    radii = np.linalg.norm(outward, axis=1)
    outward = outward / radii[:, None]
    way = []
    for start, end in pairwise(task.fiducials - center):
        ends = start / np.linalg.norm(start), end / np.linalg.norm(end)
        directions = geometric_slerp(*ends, np.linspace(0, 1, 24))
        radius = [np.sort(radii[np.argsort(-(outward @ d))[:3]])[1] for d in directions]
        way.append(center + directions * (np.array(radius)[:, None] + 1.5))
    return np.concatenate(way)


def _actor(source: vtk.vtkPolyDataAlgorithm, color: tuple[float, float, float]) -> vtk.vtkActor:
    actor, mapper = vtk.vtkActor(), vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(color)
    return actor


def _style(text: vtk.vtkTextProperty, size: int) -> None:
    text.SetFontSize(size)
    text.SetColor(TEXT)
    text.BoldOn()


if __name__ == "__main__":
    sys.exit(main())
