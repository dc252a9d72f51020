"""The 3D view and the slice views of Slicer's layout, drawn without a screen.

They are drawn by Slicer's own displayable managers, so that a picture shows what Slicer shows.
"""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import slicer
import vtk
from PySide6 import QtGui
from vtk.util.numpy_support import vtk_to_numpy

THREE_D_MANAGERS = (
    "vtkMRMLCameraDisplayableManager",
    "vtkMRMLViewDisplayableManager",
    "vtkMRMLModelDisplayableManager",
    "vtkMRMLThreeDReformatDisplayableManager",
    "vtkMRMLOrientationMarkerDisplayableManager",
    "vtkMRMLRulerDisplayableManager",
    "vtkMRMLMarkupsDisplayableManager",
    "vtkMRMLColorLegendDisplayableManager",
    "vtkMRMLLinearTransformsDisplayableManager",
    "vtkMRMLSegmentationsDisplayableManager3D",
)
SLICE_MANAGERS = (
    "vtkMRMLVolumeGlyphSliceDisplayableManager",
    "vtkMRMLModelSliceDisplayableManager",
    "vtkMRMLCrosshairDisplayableManager",
    "vtkMRMLOrientationMarkerDisplayableManager",
    "vtkMRMLRulerDisplayableManager",
    "vtkMRMLScalarBarDisplayableManager",
    "vtkMRMLMarkupsDisplayableManager",
    "vtkMRMLColorLegendDisplayableManager",
    "vtkMRMLLinearTransformsDisplayableManager",
    "vtkMRMLSegmentationsDisplayableManager2D",
)
"""Displayable managers of Slicer's views, and of modules whose nodes our module uses."""
SLICES = {"Red": "Axial", "Green": "Coronal", "Yellow": "Sagittal"}
SLICE_COLORS = {
    "Red": (0.95, 0.29, 0.20),
    "Green": (0.43, 0.72, 0.29),
    "Yellow": (0.93, 0.84, 0.30),
}


def picture_of(window: Any, width: int, height: int) -> QtGui.QImage:
    reader = vtk.vtkWindowToImageFilter(input=window, read_front_buffer=False)
    reader.Update()
    colors = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())
    rows = np.ascontiguousarray(colors.reshape(height, width, -1)[::-1, :, :3])
    image = QtGui.QImage(rows.data, width, height, 3 * width, QtGui.QImage.Format.Format_RGB888)
    return image.copy()


class View:
    """A render window without a screen, and the managers that fill it.

    The window that can draw is opened for the first picture: that takes a tenth of a second, and
    most tests need none.
    """

    def __init__(self, factory: Any, managers: tuple[str, ...], logic: Any, node: Any) -> None:
        self.node = node
        self.renderer = vtk.vtkRenderer()
        self.window = vtk.vtkGenericOpenGLRenderWindow()
        self.window.SetReadyForRendering(False)
        self.window.AddRenderer(self.renderer)
        self._interactor = vtk.vtkGenericRenderWindowInteractor()
        self._interactor.SetRenderWindow(self.window)
        factory.SetMRMLApplicationLogic(logic)
        for name in managers:
            if not factory.IsDisplayableManagerRegistered(name):
                factory.RegisterDisplayableManager(name)
        self._group = factory.InstantiateDisplayableManagers(self.renderer)
        self._group.SetMRMLDisplayableNode(node)

    def picture(self, width: int, height: int) -> QtGui.QImage:
        self._open_window()
        self.window.SetSize(width, height)
        # The labels of markups find their positions in the second one.
        self.window.Render()
        self.window.Render()
        return picture_of(self.window, width, height)

    def _open_window(self) -> None:
        if not isinstance(self.window, vtk.vtkGenericOpenGLRenderWindow):
            return
        former, self.window = self.window, vtk.vtkRenderWindow()
        self.window.SetOffScreenRendering(1)
        self.window.SetNumberOfLayers(former.GetNumberOfLayers())
        # Legends have a separate renderer, in a layer above.
        for renderer in list(former.GetRenderers()):
            former.RemoveRenderer(renderer)
            self.window.AddRenderer(renderer)
        self._interactor.SetRenderWindow(self.window)

    def legends(self, scene: Any) -> list[tuple[str, float]]:
        """Return the title of each color legend that is drawn, and its share of the view."""
        manager = self._group.GetDisplayableManagerByClassName(
            "vtkMRMLColorLegendDisplayableManager"
        )
        drawn = []
        for node in slicer.util.getNodesByClass("vtkMRMLColorLegendDisplayNode", scene):
            actor = manager.GetColorLegendActor(node)
            renderers = self.window.GetRenderers()
            is_drawn = any(renderer.HasViewProp(actor) for renderer in renderers)
            if actor is not None and actor.GetVisibility() and is_drawn:
                drawn.append((actor.GetTitle(), actor.GetWidth() * actor.GetHeight()))
        return drawn

    def close(self) -> None:
        self._group.SetMRMLDisplayableNode(None)
        self.window.Finalize()


class ThreeDView(View):
    """The 3D view."""

    def __init__(self, scene: Any, logic: Any) -> None:
        node = scene.GetSingletonNode("1", "vtkMRMLViewNode")
        if node is None:
            node = slicer.vtkMRMLViewNode(singleton_tag="1", layout_name="1", name="View1")
            node = scene.AddNode(node)
        factory = slicer.vtkMRMLThreeDViewDisplayableManagerFactory.GetInstance()
        super().__init__(factory, THREE_D_MANAGERS, logic, node)

    def look_from(self, azimuth: float, elevation: float, zoom: float) -> None:
        """Look at everything from an angle, degrees from the front."""
        self._turn(azimuth, elevation)
        self.look_at_everything()
        self.renderer.GetActiveCamera().Zoom(zoom)

    def look_at(self, place: tuple, azimuth: float, elevation: float, distance: float) -> None:
        """Look at a position, RAS mm, from an angle and a distance, mm."""
        camera = self._turn(azimuth, elevation)
        direction = camera.GetPosition()
        camera.SetFocalPoint(*place)
        camera.SetPosition(*(p + distance * d for p, d in zip(place, direction, strict=True)))
        self.renderer.ResetCameraClippingRange()

    def _turn(self, azimuth: float, elevation: float) -> Any:
        camera = self.renderer.GetActiveCamera()
        camera.SetViewAngle(30.0)
        camera.SetFocalPoint(0, 0, 0)
        camera.SetPosition(0, 1, 0)
        camera.SetViewUp(0, 0, 1)
        camera.Azimuth(azimuth)
        camera.Elevation(elevation)
        return camera

    def sees(self, model: Any) -> bool:
        """Return whether the whole model is within the picture."""
        bounds = [0.0] * 6
        model.GetRASBounds(bounds)
        for corner in itertools.product(bounds[:2], bounds[2:4], bounds[4:]):
            self.renderer.SetWorldPoint(*corner, 1.0)
            self.renderer.WorldToView()
            if max(abs(share) for share in self.renderer.GetViewPoint()[:2]) > 1.0:
                return False
        return True

    def look_at_everything(self) -> None:
        """Move the camera so that all visible models are in the picture."""
        self.renderer.ResetCamera()
        self.renderer.ResetCameraClippingRange()


def slice_logic(scene: Any, application_logic: Any, name: str) -> Any:
    """Return the logic of a slice view, with its nodes in the scene."""
    logic = slicer.vtkMRMLSliceLogic()
    logic.SetMRMLApplicationLogic(application_logic)
    logic.SetMRMLScene(scene)
    node = scene.GetSingletonNode(name, "vtkMRMLSliceNode")
    logic.SetSliceNode(node)
    node.SetOrientation(SLICES[name])
    node.SetLayoutColor(*SLICE_COLORS[name])
    return logic


class SliceView(View):
    """One of the slice views."""

    def __init__(self, application_logic: Any, logic: Any) -> None:
        self.logic = logic
        factory = slicer.vtkMRMLSliceViewDisplayableManagerFactory.GetInstance()
        super().__init__(factory, SLICE_MANAGERS, application_logic, logic.GetSliceNode())
        self._mapper = vtk.vtkImageMapper(color_window=255, color_level=127.5)
        self._actor = vtk.vtkActor2D(mapper=self._mapper)
        self._actor.GetProperty().SetDisplayLocationToBackground()

    def picture(self, width: int, height: int) -> QtGui.QImage:
        """Return the picture of the view: the slice, as large as fits, and its content."""
        self._open_window()
        # Markups place their labels by the window's size.
        self.window.SetSize(width, height)
        self.logic.ResizeSliceNode(width, height)
        offset = self.node.GetSliceOffset()
        self.logic.FitSliceToAll(width, height)
        self.node.SetSliceOffset(offset)
        self.logic.UpdatePipeline()
        connection = self.logic.GetImageDataConnection()
        if connection is None:
            self.renderer.RemoveViewProp(self._actor)
        else:
            self._mapper.SetInputConnection(connection)
            self.renderer.AddViewProp(self._actor)
        return super().picture(width, height)
