"""Give VTK's actors the finish of the scene's surfaces, in good light and in plain."""

from __future__ import annotations

from vtkmodules.vtkRenderingCore import vtkProperty

from rastrainer_simulator.desktop.glb_parts import Finish

Shade = tuple[float, float, float]


def to_srgb(color: Shade) -> Shade:
    """Return a linear color as screens take it (IEC 61966-2-1)."""
    return tuple(
        12.92 * value if value <= 0.0031308 else 1.055 * value ** (1 / 2.4) - 0.055
        for value in color
    )


def finish_surface(target: vtkProperty, finish: Finish, is_physical: bool) -> None:
    """Set a property: physically based where there is light for that, else plain."""
    if finish.is_glowing:
        glow(target, to_srgb(finish.glow))
    elif is_physical:
        target.SetInterpolationToPBR()
        target.SetColor(*finish.color)
        target.SetAmbient(0.0)
        target.SetDiffuse(1.0)
        target.SetRoughness(finish.roughness)
        target.SetMetallic(finish.metallic)
    else:
        target.SetInterpolationToPhong()
        target.SetColor(*to_srgb(finish.color))
        target.SetAmbient(0.34)
        target.SetDiffuse(0.72)
        target.SetSpecular(0.28 * (1.0 - finish.roughness))
        target.SetSpecularPower(4.0 + 40.0 * (1.0 - finish.roughness))


def glow(target: vtkProperty, color: Shade) -> None:
    """Give a surface its own color (sRGB) in any light."""
    # Not by switching the lighting off, which breaks the shader of the shadows.
    target.SetInterpolationToPhong()
    target.SetColor(*color)
    target.SetAmbient(1.0)
    target.SetDiffuse(0.0)
    target.SetSpecular(0.0)
