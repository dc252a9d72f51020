"""The light of the lowest quality: three lamps far away, without shadows or reflections."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkRenderingCore import vtkLight, vtkRenderer

LIGHTS = (
    ((-0.25, -0.55, 0.80), 0.86),
    ((0.75, -0.60, 0.25), 0.30),
    ((0.45, 0.80, 0.40), 0.45),
)
"""From the front, the side and behind, where there are touches, too: the direction toward each lamp
in World, and its intensity."""
AMBIENT, DIFFUSE = 0.34, 0.72
"""Shares of a surface's color that it shows in any light, and that it shows in the lamps' light."""


def add_plain_lights(renderer: vtkRenderer) -> None:
    """Add the lamps to a renderer."""
    for direction, intensity in LIGHTS:
        light = vtkLight()
        light.SetLightTypeToSceneLight()
        light.PositionalOff()
        light.SetPosition(*direction)
        light.SetFocalPoint(0.0, 0.0, 0.0)
        light.SetIntensity(intensity)
        renderer.AddLight(light)


def lit_colors(normals: np.ndarray, color: np.ndarray | tuple[float, float, float]) -> np.ndarray:
    """Return the color of each vertex in this light, (n, 3) uint8.

    Args:
        normals: (n, 3) float, in World, of unit length.
        color: of the surface, or (n, 3) of each vertex, sRGB, 0 to 1.
    """
    light = np.full(len(normals), AMBIENT)
    for direction, intensity in LIGHTS:
        toward = np.array(direction) / np.linalg.norm(direction)
        light += DIFFUSE * intensity * np.clip(normals @ toward, 0.0, None)
    return (255.0 * np.clip(light[:, None] * np.array(color), 0.0, 1.0) + 0.5).astype(np.uint8)
