"""A scene drawn at a fraction of its resolution, for machines without a graphics processor."""

from __future__ import annotations

import math

from rastrainer_simulator.desktop.gl_window import GlWindow
from rastrainer_simulator.desktop.kept_view import LINEAR, KeptView, Rectangle, copy_frame

MAX_PIXELS = 1_200_000
"""So many are drawn fast enough by a processor; more than 1366 × 768, fewer than 1600 × 900."""


class ReducedScene:
    """Draws one view into a corner of its window, and then that corner over all of it.

    What is drawn after it, such as texts, keeps the window's resolution.

    Attributes:
        divisor: by which width and height are divided; 1 draws as usual.
        is_coarse: whether the last picture was drawn at a fraction.
    """

    def __init__(self, window: GlWindow, view: KeptView) -> None:
        self.divisor = 1
        self.is_coarse = False
        self._window = window
        self._view = view
        # VTK's stubs leave out that events have names.
        view.moving.AddObserver("EndEvent", lambda *_event: self._enlarge())  # type: ignore[arg-type]

    def fit(self, is_reduced: bool) -> None:
        """Set what the next picture is drawn with, by the size of the window."""
        width, height = self._window.size
        self.divisor = math.ceil(math.sqrt(width * height / MAX_PIXELS)) if is_reduced else 1
        self._view.place(self._corner)

    @property
    def _corner(self) -> Rectangle:
        width, height = self._window.size
        return 0, width // self.divisor, 0, height // self.divisor

    def _enlarge(self) -> None:
        self.is_coarse = self.divisor > 1
        if not self.is_coarse:
            return
        width, height = self._window.size
        _, right, _, top = corner = self._corner
        window = self._window
        drawn = window.render_window.GetRenderFramebuffer()
        spare = window.render_window.GetDisplayFramebuffer()
        # By way of another buffer: no part of a buffer may be copied over itself.
        copy_frame(window, drawn, corner, spare, corner)
        # Its last pixels are mixed with those beyond: the same again, not those of another picture.
        last_row, beyond = (0, right, top - 1, top), (0, right, top, top + 1)
        copy_frame(window, drawn, last_row, spare, beyond)
        last_column, beside = (right - 1, right, 0, top), (right, right + 1, 0, top)
        copy_frame(window, drawn, last_column, spare, beside)
        whole = (0, width, 0, height)
        copy_frame(window, spare, corner, drawn, whole, filtering=LINEAR)
