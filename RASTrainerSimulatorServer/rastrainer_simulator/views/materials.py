"""How surfaces look: physically based materials."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from vtkmodules.vtkRenderingCore import vtkProperty

Color = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """A surface's color (sRGB, 0…1), roughness and metallicity; a `glowing` one needs no light."""

    color: Color
    roughness: float = 0.5
    metallic: float = 0.0
    glowing: bool = False

    def apply(self, target: vtkProperty) -> None:
        """Set it on an actor's property."""
        if self.glowing:
            # Shadows need a lit material: switching its lighting off breaks their shader.
            target.SetColor(*self.color)
            target.SetAmbient(1.0)
            target.SetDiffuse(0.0)
            return
        target.SetInterpolationToPBR()
        target.SetColor(*(channel**2.2 for channel in self.color))  # VTK's PBR wants it linear
        target.SetRoughness(self.roughness)
        target.SetMetallic(self.metallic)


SKIN = Material((0.87, 0.67, 0.56), 0.55)
STEEL = Material((0.78, 0.79, 0.80), 0.35, 0.6)
TABLE_TOP = Material((0.68, 0.69, 0.68), 0.5)
MAT = Material((0.26, 0.47, 0.52), 0.8)
FLOOR = Material((0.47, 0.51, 0.55), 0.55)
WALL = Material((0.92, 0.93, 0.92), 0.9)
WALL_BAND = Material((0.55, 0.70, 0.72), 0.8)

TIP_FREE = Material((0.05, 0.30, 1.0), glowing=True)
TIP_NEAR = Material((1.0, 0.05, 0.05), glowing=True)

WAITING = Material((0.10, 0.24, 0.62), glowing=True)
NEXT = Material((1.0, 0.80, 0.05), glowing=True)
TOUCHED = Material((0.10, 0.62, 0.25), glowing=True)
MARK_RIM = Material((0.97, 0.97, 0.97), glowing=True)
NUMBER = Material((0.07, 0.09, 0.16), glowing=True)


def painted(color: Sequence[float]) -> Material:
    """Return the coating of a robot part: the color its URDF names, a little glossy."""
    return Material((color[0], color[1], color[2]), 0.38)
