"""Render without any window or display, and write pictures as PNG files."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401  (registers the renderer)
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

from rastrainer.errors import InputError
from rastrainer.scenario.scenario import Camera
from rastrainer.transforms import MM_PER_M


def look_through(camera: Camera, renderer: vtkRenderer) -> None:
    """Set a renderer's camera; the scenario's is in mm, what is rendered in metres."""
    view = renderer.GetActiveCamera()
    view.SetPosition(*(camera.position / MM_PER_M))
    view.SetFocalPoint(*(camera.focal_point / MM_PER_M))
    view.SetViewUp(*camera.view_up)
    view.SetViewAngle(camera.view_angle_deg)
    renderer.ResetCameraClippingRange()


class OffscreenWindow:
    """A renderer's picture in memory; its graphics resources are kept from frame to frame."""

    def __init__(self, renderer: vtkRenderer):
        self._renderer = renderer
        with _without_display_warning():
            self._window = vtkRenderWindow()
        self._window.SetOffScreenRendering(True)
        self._window.SetMultiSamples(0)
        self._window.AddRenderer(renderer)

    def frame(self, camera: Camera, size: tuple[int, int]) -> np.ndarray:
        """Return (height, width, 3) uint8, the top row first, for `size` = (width, height)."""
        self._window.SetSize(*size)
        look_through(camera, self._renderer)
        with _without_display_warning():
            self._window.Render()
        shot = vtkWindowToImageFilter()
        shot.SetInput(self._window)
        shot.ReadFrontBufferOff()
        shot.ShouldRerenderOff()
        shot.Update()
        pixels = vtk_to_numpy(shot.GetOutput().GetPointData().GetScalars())
        return pixels.reshape(size[1], size[0], 3)[::-1].copy()

    def close(self) -> None:
        """Free the graphics resources."""
        self._window.Finalize()


def write_png(pixels: np.ndarray, path: Path) -> None:
    """Write (height, width, 3) uint8 pixels, whole or not at all, in place of an older picture.

    Raises:
        InputError: the file cannot be written.
    """
    height, width, _ = pixels.shape
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(pixels[::-1].reshape(-1, 3), deep=True))
    writer = vtkPNGWriter()
    writer.SetInputData(image)
    writer.WriteToMemoryOn()
    writer.Write()
    partial = path.with_name(path.name + ".partial")
    try:
        partial.write_bytes(vtk_to_numpy(writer.GetResult()).tobytes())
        partial.replace(path)
    except OSError as error:
        raise InputError(f"The picture {path} cannot be written: {error.strerror}.") from error


@contextmanager
def _without_display_warning() -> Iterator[None]:
    """Keep VTK from warning that there is no display: none is needed. Errors are still shown."""
    before = vtkLogger.GetCurrentVerbosityCutoff()
    vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
    try:
        yield
    finally:
        vtkLogger.SetStderrVerbosity(before)
