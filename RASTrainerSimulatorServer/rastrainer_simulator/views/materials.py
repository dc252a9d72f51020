"""Give VTK's actors the materials of a scene."""

from __future__ import annotations

from vtkmodules.vtkRenderingCore import vtkProperty

from rastrainer_simulator.scene.materials import Material


def apply_material(material: Material, target: vtkProperty) -> None:
    """Set a material on an actor's property."""
    if material.glowing:
        # Shadows need a lit material: switching its lighting off breaks their shader.
        target.SetColor(*material.color)
        target.SetAmbient(1.0)
        target.SetDiffuse(0.0)
        return
    target.SetInterpolationToPBR()
    target.SetColor(*material.linear_color)
    target.SetRoughness(material.roughness)
    target.SetMetallic(material.metallic)
