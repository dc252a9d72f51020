"""Copy rectangles between OpenGL's framebuffers."""

from __future__ import annotations

from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLFramebufferObject

from rastrainer_simulator.desktop.gl_window import GlWindow

Rectangle = tuple[int, int, int, int]
"""Left, right, bottom and top, in pixels."""

# OpenGL's names, of which VTK's Python has none.
_GL_READ_FRAMEBUFFER, _GL_DRAW_FRAMEBUFFER = 0x8CA8, 0x8CA9
_GL_SCISSOR_TEST = 0x0C11
COLORS, DEPTHS = 0x4000, 0x0100
NEAREST, LINEAR = 0x2600, 0x2601


def copy_frame(
    window: GlWindow,
    source: vtkOpenGLFramebufferObject,
    of: Rectangle,
    target: vtkOpenGLFramebufferObject,
    to: Rectangle,
    what: int = COLORS,
    filtering: int = NEAREST,
) -> None:
    """Copy a rectangle; colors are scaled where the other one is larger, depths cannot be."""
    state = window.render_window.GetState()
    state.PushFramebufferBindings()
    # The next renderer switches it on again, for its own part of the window.
    state.vtkglDisable(_GL_SCISSOR_TEST)
    source.Bind(_GL_READ_FRAMEBUFFER)
    target.Bind(_GL_DRAW_FRAMEBUFFER)
    vtkOpenGLFramebufferObject.Blit(of, to, what, filtering)
    state.PopFramebufferBindings()
