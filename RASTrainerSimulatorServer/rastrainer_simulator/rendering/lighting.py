"""Light as in a bright room, with soft shadows."""

from __future__ import annotations

from enum import Enum

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
    vtkTranslucentPass,
)

SURROUNDINGS = 0.55
# Windows and ceiling lights that glossy parts mirror: azimuth, elevation, half widths (rad), glow.
PANELS = ((-1.6, 0.75, 0.45, 0.22, 4.0), (0.4, 1.0, 0.3, 0.2, 3.0), (2.8, 0.7, 0.4, 0.25, 2.5))

# The lamp shines past the arm onto the face. Its cone covers only what the cameras see, because the
# pixels of the shadows are spread over it.
LAMP_AT = (0.35, 0.0, 0.2)
LAMP_PLACE = (1.70, -1.65, 2.45)
LAMP_CONE_DEG = 33.0
LAMP_RADIUS = 0.06
LAMP_CORNERS = ((0.0, 1.0), (-0.87, -0.5), (0.87, -0.5))
LAMP_INTENSITY = 2.3

# Without shadows the lamp has no edge and is dimmer: nothing keeps its light from the walls.
OPEN_CONE_DEG = 80.0
OPEN_INTENSITY = 1.3


class Shadows(Enum):
    """How much is shaded: nothing, what a small picture needs, or all; pixels of each lamp's map.

    Corners are shaded only in a picture that fills its window.
    """

    NONE = 0
    SMALL = 1024
    FULL = 3072


def light_room(renderer: vtkRenderer, shadows: Shadows = Shadows.FULL) -> None:
    """Give a renderer its surroundings, lamps and smooth edges, and shadows if wanted."""
    # The surroundings as light by direction: a pale room with bright panels.
    width, height = 128, 64
    elevation = np.linspace(-np.pi / 2, np.pi / 2, height)[:, None]
    azimuth = np.linspace(-np.pi, np.pi, width)[None, :]
    light = np.broadcast_to(SURROUNDINGS * (0.92 + 0.2 * np.sin(elevation)), (height, width)).copy()
    for toward, above, wide, high, glow in PANELS:
        across, upward = (azimuth - toward) / wide, (elevation - above) / high
        light += glow * np.exp(-(across**4) - upward**4)
    pixels = np.repeat(light.reshape(-1, 1), 3, axis=1).astype(np.float32)
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(pixels, deep=True))
    texture = vtkTexture()
    texture.SetInputData(image)
    texture.SetColorModeToDirectScalars()
    texture.MipmapOn()
    texture.InterpolateOn()
    renderer.SetEnvironmentTexture(texture)
    renderer.SetEnvironmentUp(0.0, 0.0, 1.0)
    renderer.SetEnvironmentRight(1.0, 0.0, 0.0)
    renderer.UseImageBasedLightingOn()
    # Few samples: the surroundings are smooth, and software rendering pays for each.
    # These are the OpenGL renderer's; VTK's stubs promise its base class.
    renderer.GetEnvMapPrefiltered().SetPrefilterMaxSamples(32)  # type: ignore[attr-defined]
    renderer.GetEnvMapLookupTable().SetLUTSamples(16)  # type: ignore[attr-defined]
    left, front, up = LAMP_PLACE
    for x, y in LAMP_CORNERS:
        # Together they cast the soft shadows of one wide lamp.
        lamp = vtkLight()
        lamp.SetLightTypeToSceneLight()
        lamp.PositionalOn()
        lamp.SetPosition(left + x * LAMP_RADIUS, front, up + y * LAMP_RADIUS)
        lamp.SetFocalPoint(*LAMP_AT)
        lamp.SetColor(1.0, 0.97, 0.93)
        is_open = shadows is Shadows.NONE
        lamp.SetConeAngle(OPEN_CONE_DEG if is_open else LAMP_CONE_DEG)
        lamp.SetIntensity((OPEN_INTENSITY if is_open else LAMP_INTENSITY) / len(LAMP_CORNERS))
        renderer.AddLight(lamp)
    if shadows is Shadows.NONE:
        renderer.UseFXAAOn()
    else:
        renderer.SetPass(_passes(shadows))


def _passes(shadows: Shadows) -> vtkRenderPass:
    """Return the steps of a picture: shadows, transparent surfaces, shaded corners, edges."""
    cast = vtkShadowMapPass()
    cast.GetShadowMapBakerPass().SetResolution(shadows.value)
    steps = vtkRenderPassCollection()
    steps.AddItem(cast.GetShadowMapBakerPass())
    steps.AddItem(cast)
    steps.AddItem(vtkTranslucentPass())
    sequence = vtkSequencePass()
    sequence.SetPasses(steps)
    camera = vtkCameraPass()
    camera.SetDelegatePass(sequence)
    smooth = vtkOpenGLFXAAPass()
    smooth.SetDelegatePass(camera)
    if shadows is Shadows.FULL:
        corners = vtkSSAOPass()
        corners.SetRadius(0.10)
        corners.SetBias(0.004)
        corners.SetKernelSize(32)
        corners.BlurOn()
        corners.SetDelegatePass(camera)
        smooth.SetDelegatePass(corners)
    return smooth
