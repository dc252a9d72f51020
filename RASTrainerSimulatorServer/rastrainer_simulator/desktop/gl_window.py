"""A window of SDL's into which VTK draws.

On every system, SDL reports typed text, repeats, the loss of the focus and keys by their place on
the keyboard, all of which VTK's own windows leave out.
"""

from __future__ import annotations

import os

import numpy as np
import pygame
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkLogger
from vtkmodules.vtkRenderingCore import vtkWindowToImageFilter
from vtkmodules.vtkRenderingOpenGL2 import vtkGenericOpenGLRenderWindow

from rastrainer.errors import RASTrainerError
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import Color, rgba

TITLE = "RASTrainer"
LEAST_SIZE = (960, 540)
REPEAT_AFTER_MS, REPEAT_EVERY_MS = 450, 45
SOFTWARE_RENDERERS = (
    "llvmpipe",
    "softpipe",
    "swrast",
    "swr",
    "swiftshader",
    "software",
    "microsoft basic render",
    "gdi generic",
)
NO_WINDOW = "No window can be opened on this machine: {reason}."
_CORE_PROFILE = {
    pygame.GL_CONTEXT_MAJOR_VERSION: 3,
    pygame.GL_CONTEXT_MINOR_VERSION: 2,
    pygame.GL_CONTEXT_PROFILE_MASK: pygame.GL_CONTEXT_PROFILE_CORE,
    pygame.GL_DOUBLEBUFFER: 1,
    pygame.GL_DEPTH_SIZE: 24,
}


class GlWindow:
    """The window and its OpenGL context.

    Attributes:
        render_window: VTK's; what it renders appears in the window.
        renderer_name: of OpenGL, such as "llvmpipe (LLVM 15.0.6, 256 bits)".
        refresh_hz: of the display, 0 where unknown.
    """

    def __init__(self, size: tuple[int, int] | None, is_fullscreen: bool, is_hidden: bool = False):
        """Open the window, as large as the display allows where no size is given.

        A hidden one is never seen: its pixels are for a file.

        Raises:
            RASTrainerError: there is no display, or no OpenGL.
        """
        # VTK's warnings about its own render passes are not for users; errors still are.
        vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_ERROR)
        # A trainee may look at the screen for a long time without touching a key.
        os.environ.setdefault("SDL_VIDEO_ALLOW_SCREENSAVER", "0")
        try:
            pygame.display.init()
            for attribute, value in _CORE_PROFILE.items():
                pygame.display.gl_set_attribute(attribute, value)
            self._window = pygame.Window(
                TITLE, size or _roomy_size(), opengl=True, resizable=True, hidden=is_hidden
            )
        except pygame.error as error:
            raise RASTrainerError(NO_WINDOW.format(reason=error)) from None
        self._window.set_icon(
            pygame.image.frombuffer(window_icon().tobytes(), (ICON_SIZE, ICON_SIZE), "RGBA")
        )
        pygame.key.set_repeat(REPEAT_AFTER_MS, REPEAT_EVERY_MS)
        self._window.minimum_size = tuple(
            min(least, own) for least, own in zip(LEAST_SIZE, self.size, strict=True)
        )
        self._is_fullscreen = False
        if is_fullscreen:
            self.toggle_fullscreen()
        self.refresh_hz = float(max([0, *pygame.display.get_desktop_refresh_rates()]))
        self.render_window = self._make_render_window()
        self.renderer_name = _renderer_name(self.render_window)

    @property
    def size(self) -> tuple[int, int]:
        width, height = self._window.size
        return max(1, width), max(1, height)

    def toggle_fullscreen(self) -> None:
        """Fill the display, or be a window again."""
        self._is_fullscreen = not self._is_fullscreen
        if self._is_fullscreen:
            self._window.set_fullscreen(desktop=True)
        else:
            self._window.set_windowed()

    def shrink_to(self, most: tuple[int, int]) -> None:
        """Make the window no larger than a size in pixels; one that fills the display stays."""
        width, height = self.size
        if not self._is_fullscreen:
            self._window.size = min(width, most[0]), min(height, most[1])

    def fit(self) -> None:
        """Have VTK draw as large as the window is."""
        if self.render_window.GetSize() != self.size:
            self.render_window.SetSize(*self.size)

    def pixels(self) -> np.ndarray:
        """Return (height, width, 3) uint8 of what was rendered last, the top row first."""
        shot = vtkWindowToImageFilter()
        shot.SetInput(self.render_window)
        shot.ReadFrontBufferOff()
        shot.ShouldRerenderOff()
        shot.Update()
        image = shot.GetOutput()
        width, height, _ = image.GetDimensions()
        pixels = vtk_to_numpy(image.GetPointData().GetScalars())
        return pixels.reshape(height, width, 3)[::-1].copy()

    def close(self) -> None:
        """Free the graphics resources and close the window."""
        self.render_window.Finalize()
        self._window.destroy()
        pygame.display.quit()

    def _make_render_window(self) -> vtkGenericOpenGLRenderWindow:
        window = vtkGenericOpenGLRenderWindow()
        answers = {
            "WindowMakeCurrentEvent": lambda *_event: None,
            "WindowIsCurrentEvent": lambda *_event: window.SetIsCurrent(True),
            "WindowSupportsOpenGLEvent": lambda *_event: window.SetSupportsOpenGL(1),
            "WindowIsDirectEvent": lambda *_event: window.SetIsDirect(1),
            "WindowFrameEvent": lambda *_event: self._window.flip(),
        }
        for name, answer in answers.items():
            # VTK's stubs leave out that events have names.
            window.AddObserver(name, answer)  # type: ignore[arg-type]
        window.SetOwnContext(False)
        window.SetMapped(True)
        window.SetReadyForRendering(True)
        window.OpenGLInitContext()
        # As VTK does for windows that it makes itself; without, no panel covers another.
        window.GetState().Initialize(window)
        window.SetMultiSamples(0)
        window.SetSize(*self.size)
        return window


def _roomy_size() -> tuple[int, int]:
    """Return a size of 16:9 that leaves room for the desktop's own bars."""
    width, height = pygame.display.get_desktop_sizes()[0]
    unit = max(30, min(round(0.86 * width / 16), round(0.86 * height / 9)))
    return 16 * unit, 9 * unit


def is_software_renderer(name: str) -> bool:
    """Return whether the processor draws, by OpenGL's name of the renderer."""
    return any(known in name.lower() for known in SOFTWARE_RENDERERS)


def _renderer_name(window: vtkGenericOpenGLRenderWindow) -> str:
    lines = window.ReportCapabilities().splitlines()
    found = [line for line in lines if line.startswith("OpenGL renderer string:")]
    return found[0].partition(":")[2].strip() if found else ""


ICON_SIZE = 64
NIGHT, SKIN, ARM = rgba(0x0E1726), rgba(0xD9A88C), rgba(0xF07818)
DISKS: tuple[tuple[int, int, int, Color], ...] = (
    (42, 42, 17, SKIN),
    (34, 31, 4, rgba(0xFFE14A)),
    (46, 31, 4, rgba(0x199E40)),
    (53, 40, 4, rgba(0x199E40)),
)


def window_icon() -> np.ndarray:
    """Return the window's icon, (64, 64, 4) uint8: a head, its fiducials, the tool at the next."""
    canvas = Canvas(ICON_SIZE, ICON_SIZE)
    canvas.box(Box(0, 0, ICON_SIZE, ICON_SIZE), NIGHT, 12)
    for x, y, radius, color in DISKS:
        canvas.box(Box(x - radius, y - radius, 2 * radius, 2 * radius), color, radius)
    canvas.stroke([(10, 54), (10, 30), (24, 14), (32, 27)], 6, ARM)
    return canvas.pixels()
