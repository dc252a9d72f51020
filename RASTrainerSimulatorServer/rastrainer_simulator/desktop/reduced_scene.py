"""A scene drawn at a fraction of its resolution, for machines without a graphics processor."""

from __future__ import annotations

import math

from vtkmodules.vtkRenderingCore import vtkRenderer
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLFramebufferObject

from rastrainer_simulator.desktop.gl_window import GlWindow

MAX_PIXELS = 1_200_000
"""So many are drawn fast enough by a processor; more than 1366 × 768, fewer than 1600 × 900."""

# OpenGL's names, of which VTK's Python has none.
_GL_READ_FRAMEBUFFER, _GL_DRAW_FRAMEBUFFER = 0x8CA8, 0x8CA9
_GL_COLOR_BUFFER_BIT, _GL_SCISSOR_TEST = 0x4000, 0x0C11
_GL_NEAREST, _GL_LINEAR = 0x2600, 0x2601


class ReducedScene:
    """Draws one renderer into a corner of its window, and then that corner over all of it.

    What is drawn after it, such as texts, keeps the window's resolution.

    Attributes:
        divisor: by which width and height are divided; 1 draws as usual.
    """

    def __init__(self, window: GlWindow, renderer: vtkRenderer) -> None:
        self.divisor = 1
        self._window = window
        self._renderer = renderer
        # VTK's stubs leave out that events have names.
        renderer.AddObserver("EndEvent", lambda *_event: self._enlarge())  # type: ignore[arg-type]

    def fit(self, is_reduced: bool) -> None:
        """Set what the next picture is drawn with, by the size of the window."""
        width, height = self._window.size
        needed = math.ceil(math.sqrt(width * height / MAX_PIXELS)) if is_reduced else 1
        self.divisor = needed
        self._renderer.SetViewport(0.0, 0.0, (width // needed) / width, (height // needed) / height)

    def _enlarge(self) -> None:
        if self.divisor == 1:
            return
        width, height = self._window.size
        right, top = width // self.divisor, height // self.divisor
        corner = (0, right, 0, top)
        window = self._window.render_window
        drawn, spare = window.GetRenderFramebuffer(), window.GetDisplayFramebuffer()
        state = window.GetState()
        state.PushFramebufferBindings()
        # The next renderer switches it on again, for its own part of the window.
        state.vtkglDisable(_GL_SCISSOR_TEST)
        # By way of another buffer: no part of a buffer may be copied over itself.
        _copy(drawn, corner, spare, corner, _GL_NEAREST)
        # Its last pixels are mixed with those beyond: the same again, not those of another picture.
        _copy(drawn, (0, right, top - 1, top), spare, (0, right, top, top + 1), _GL_NEAREST)
        _copy(drawn, (right - 1, right, 0, top), spare, (right, right + 1, 0, top), _GL_NEAREST)
        _copy(spare, corner, drawn, (0, width, 0, height), _GL_LINEAR)
        state.PopFramebufferBindings()


def _copy(
    source: vtkOpenGLFramebufferObject,
    of: tuple[int, int, int, int],
    target: vtkOpenGLFramebufferObject,
    to: tuple[int, int, int, int],
    filtering: int,
) -> None:
    """Copy the colors of a rectangle (left, right, bottom, top), in pixels."""
    source.Bind(_GL_READ_FRAMEBUFFER)
    target.Bind(_GL_DRAW_FRAMEBUFFER)
    vtkOpenGLFramebufferObject.Blit(of, to, _GL_COLOR_BUFFER_BIT, filtering)
