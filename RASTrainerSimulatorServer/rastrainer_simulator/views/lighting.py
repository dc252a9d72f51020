"""Light as in a bright room: soft surroundings, lamps with soft shadows, shaded corners."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkLight, vtkRenderer, vtkRenderPass, vtkTexture
from vtkmodules.vtkRenderingOpenGL2 import (
    vtkCameraPass,
    vtkOpenGLFXAAPass,
    vtkRenderPassCollection,
    vtkSequencePass,
    vtkShadowMapPass,
    vtkSSAOPass,
)

AMBIENT = 0.55
# Windows and ceiling lights that glossy parts mirror: azimuth, elevation, half widths (rad), glow.
PANELS = ((-1.6, 0.75, 0.45, 0.22, 4.0), (0.4, 1.0, 0.3, 0.2, 3.0), (2.8, 0.7, 0.4, 0.25, 2.5))

# The lamp is far: its light is parallel, so that its shadows cover the whole room alike.
LAMP_DIRECTION = (0.22, 0.45, -0.87)
LAMP_SPREAD = 0.02
LAMP_CORNERS = ((0.0, 1.0), (-0.87, -0.5), (0.87, -0.5))
LAMP_INTENSITY = 2.5
SHADOW_PIXELS = 2048


def light_room(renderer: vtkRenderer, has_shadows: bool = True) -> None:
    """Give a renderer its surroundings, lamps and smooth edges, and shadows where wanted."""
    _surround(renderer)
    for x, y in LAMP_CORNERS:
        renderer.AddLight(_lamp(x * LAMP_SPREAD, y * LAMP_SPREAD))
    if has_shadows:
        renderer.SetPass(_passes())
    else:
        renderer.UseFXAAOn()


def _surround(renderer: vtkRenderer) -> None:
    renderer.SetEnvironmentTexture(_environment())
    renderer.SetEnvironmentUp(0.0, 0.0, 1.0)
    renderer.SetEnvironmentRight(1.0, 0.0, 0.0)
    renderer.UseImageBasedLightingOn()
    # Few samples: the surroundings are smooth, and software rendering pays for each.
    renderer.GetEnvMapPrefiltered().SetPrefilterMaxSamples(32)
    renderer.GetEnvMapLookupTable().SetLUTSamples(16)


def _environment(width: int = 128) -> vtkTexture:
    """Return the surroundings as light by direction: a pale room with bright panels."""
    elevation = np.linspace(-np.pi / 2, np.pi / 2, width // 2)[:, None]
    azimuth = np.linspace(-np.pi, np.pi, width)[None, :]
    light = np.broadcast_to(AMBIENT * (0.92 + 0.2 * np.sin(elevation)), (width // 2, width)).copy()
    for toward, above, wide, high, glow in PANELS:
        across, upward = (azimuth - toward) / wide, (elevation - above) / high
        light += glow * np.exp(-(across**4) - upward**4)
    pixels = np.repeat(light.reshape(-1, 1), 3, axis=1).astype(np.float32)
    image = vtkImageData()
    image.SetDimensions(width, width // 2, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(pixels, deep=True))
    texture = vtkTexture()
    texture.SetInputData(image)
    texture.SetColorModeToDirectScalars()
    texture.MipmapOn()
    texture.InterpolateOn()
    return texture


def _lamp(aside: float, above: float) -> vtkLight:
    """Return one of the lights that together cast the soft shadows of one wide lamp."""
    x, y, z = LAMP_DIRECTION
    lamp = vtkLight()
    lamp.SetLightTypeToSceneLight()
    lamp.PositionalOff()
    lamp.SetPosition(-x + aside, -y, -z + above)
    lamp.SetFocalPoint(0.0, 0.0, 0.0)
    lamp.SetIntensity(LAMP_INTENSITY / len(LAMP_CORNERS))
    lamp.SetColor(1.0, 0.97, 0.93)
    return lamp


def _passes() -> vtkRenderPass:
    """Return the steps of a picture: shadows, within shaded corners, within smoothed edges."""
    shadows = vtkShadowMapPass()
    shadows.GetShadowMapBakerPass().SetResolution(SHADOW_PIXELS)
    steps = vtkRenderPassCollection()
    steps.AddItem(shadows.GetShadowMapBakerPass())
    steps.AddItem(shadows)
    sequence = vtkSequencePass()
    sequence.SetPasses(steps)
    camera = vtkCameraPass()
    camera.SetDelegatePass(sequence)
    corners = vtkSSAOPass()
    corners.SetRadius(0.10)
    corners.SetBias(0.004)
    corners.SetKernelSize(64)
    corners.BlurOn()
    corners.SetDelegatePass(camera)
    smooth = vtkOpenGLFXAAPass()
    smooth.SetDelegatePass(corners)
    return smooth
