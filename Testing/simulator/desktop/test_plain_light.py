"""The light of the lowest quality, computed beforehand and by VTK."""

import numpy as np
import pytest
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer

from rastrainer_simulator.desktop.inbox import Finish
from rastrainer_simulator.desktop.shown_scene import finish_surface, to_srgb
from rastrainer_simulator.rendering.lighting import add_plain_lights, lit_colors
from rastrainer_simulator.scene.surfaces import surface

MATTE = Finish((0.4, 0.2, 0.1), (0.0, 0.0, 0.0), roughness=1.0, metallic=0.0)
SQUARE = np.array([[-1.0, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]])


@pytest.mark.parametrize("normal", [(0, -1, 0), (0.6, -0.8, 0), (-0.48, -0.6, 0.64)])
def test_a_static_surface_is_as_bright_as_vtk_renders_it(gl_window, normal):
    normals = np.tile(np.array(normal, dtype=np.float32), (4, 1))
    data = surface(SQUARE, np.array([[0, 1, 2], [0, 2, 3]]), normals)
    mapper, actor, renderer = vtkPolyDataMapper(), vtkActor(), vtkRenderer()
    mapper.SetInputData(data)
    actor.SetMapper(mapper)
    finish_surface(actor.GetProperty(), MATTE, is_physical=False)
    renderer.AutomaticLightCreationOff()
    add_plain_lights(renderer)
    renderer.AddActor(actor)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(0.0, -2.0, 0.0)
    camera.SetFocalPoint(0.0, 0.0, 0.0)
    camera.SetViewUp(0.0, 0.0, 1.0)
    gl_window.render_window.AddRenderer(renderer)
    try:
        gl_window.render_window.Render()
        height, width, _ = gl_window.pixels().shape
        drawn = gl_window.pixels()[height // 2, width // 2].astype(int)
    finally:
        gl_window.render_window.RemoveRenderer(renderer)
    computed = lit_colors(normals.astype(float), to_srgb(MATTE.color))[0].astype(int)
    assert np.abs(drawn - computed).max() <= 2
