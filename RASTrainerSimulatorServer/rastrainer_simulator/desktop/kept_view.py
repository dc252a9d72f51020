"""One view of the scene, in which what stands still is drawn once and kept with its depths.

A processor that draws spends most of a picture's time on the head and the room, which are the same
in the next picture while the camera stands: copying them is several times faster. What cannot be
kept is drawn at a fraction of the window's resolution.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable

from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR
from vtkmodules.vtkCommonDataModel import vtkBoundingBox
from vtkmodules.vtkRenderingCore import vtkProp3D, vtkRenderer
from vtkmodules.vtkRenderingOpenGL2 import vtkOpenGLFramebufferObject

from rastrainer_simulator.desktop.gl_window import GlWindow
from rastrainer_simulator.desktop.inbox import Viewpoint
from rastrainer_simulator.desktop.shown_scene import ShownScene

Rectangle = tuple[int, int, int, int]
"""Left, right, bottom and top, in pixels."""

# OpenGL's names, of which VTK's Python has none.
_GL_READ_FRAMEBUFFER, _GL_DRAW_FRAMEBUFFER = 0x8CA8, 0x8CA9
_GL_SCISSOR_TEST = 0x0C11
COLORS, DEPTHS = 0x4000, 0x0100
NEAREST, LINEAR = 0x2600, 0x2601
_DEPTH_BITS = 32
"""As VTK's own framebuffer has them: depths are only copied between equal formats."""
SPARE = 0.5
"""So much nearer than the nearest, and as much farther, a camera sees, so that the arm may move."""
MAX_PIXELS = 1_200_000
"""So many are drawn fast enough by a processor; more than 1366 × 768, fewer than 1600 × 900."""


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


class KeptView:
    """Draws what stands still into the picture or copies it, and what moves over it.

    Attributes:
        still, moving: renderers with one camera and one viewport. Where nothing is kept, `still`
            draws everything, and `moving` nothing.
        translucent: names of the bodies that are seen through in this view.
    """

    def __init__(self, window: GlWindow):
        self.still, self.moving = vtkRenderer(), vtkRenderer()
        for renderer in (self.still, self.moving):
            renderer.AutomaticLightCreationOff()
            window.render_window.AddRenderer(renderer)
        self.moving.SetActiveCamera(self.still.GetActiveCamera())
        self.moving.PreserveColorBufferOn()
        self.moving.PreserveDepthBufferOn()
        self.translucent: Collection[str] = ()
        self._window = window
        self._scene: ShownScene | None = None
        self._is_split = False
        self._rectangle: Rectangle = (0, 0, 0, 0)
        self._frame: vtkOpenGLFramebufferObject | None = None
        self._drawn: tuple[object, ...] | None = None
        self._kept: tuple[object, ...] | None = None
        # VTK's stubs leave out that events have names.
        for renderer in (self.still, self.moving):
            renderer.AddObserver("StartEvent", lambda *_event: self._see_through())  # type: ignore[arg-type]
        self.still.AddObserver("EndEvent", lambda *_event: self._keep())  # type: ignore[arg-type]
        self.moving.AddObserver("StartEvent", lambda *_event: self._lay())  # type: ignore[arg-type]
        self.moving.AddObserver("EndEvent", lambda *_event: self._note())  # type: ignore[arg-type]

    def show(self, scene: ShownScene, is_split: bool) -> None:
        """Show a scene; `is_split` keeps what stands still."""
        self._scene, self._is_split = scene, is_split
        self._drawn = self._kept = None
        _fill(self.still, scene.still if is_split else scene.actors)
        _fill(self.moving, scene.moving if is_split else ())

    def look(self, viewpoint: Viewpoint) -> None:
        """Set the camera."""
        camera = self.still.GetActiveCamera()
        before, (near, far) = self._camera, camera.GetClippingRange()
        camera.SetPosition(*viewpoint.position)
        camera.SetFocalPoint(*viewpoint.focal_point)
        camera.SetViewUp(*viewpoint.view_up)
        camera.SetViewAngle(viewpoint.angle_deg)
        camera.SetWindowCenter(-viewpoint.aside, 0.0)
        box = vtkBoundingBox()
        for renderer in (self.still, self.moving):
            if renderer.VisibleActorCount():
                box.AddBounds(renderer.ComputeVisiblePropBounds())
        if not box.IsValid():
            return
        bounds = [0.0] * 6
        box.GetBounds(bounds)
        self.still.ResetCameraClippingRange(bounds)
        nearest, farthest = camera.GetClippingRange()
        if self._camera == before and near <= nearest and farthest <= far:
            # Depths are kept only as long as the range is the same.
            camera.SetClippingRange(near, far)
        else:
            camera.SetClippingRange(SPARE * nearest, farthest / SPARE)

    def place(self, rectangle: Rectangle) -> None:
        """Draw into a part of the window, in pixels: left, right, bottom, top."""
        width, height = self._window.size
        left, right, bottom, top = self._rectangle = rectangle
        viewport = left / width, bottom / height, right / width, top / height
        for renderer in (self.still, self.moving):
            renderer.SetViewport(*viewport)
        self.still.SetDraw(not self._has_kept)
        self.moving.DrawOn()

    def hide(self) -> None:
        self.still.DrawOff()
        self.moving.DrawOff()

    @property
    def is_settled(self) -> bool:
        """Whether what stands still looks as in the picture before, so that it can be kept."""
        return self._is_split and self._look == self._drawn

    @property
    def _look(self) -> tuple[object, ...]:
        version = None if self._scene is None else self._scene.still_version
        depths = self.still.GetActiveCamera().GetClippingRange()
        return version, self._camera, depths, self._window.size

    @property
    def _camera(self) -> tuple[object, ...]:
        camera = self.still.GetActiveCamera()
        place = camera.GetPosition(), camera.GetFocalPoint(), camera.GetViewUp()
        return *place, camera.GetViewAngle(), camera.GetWindowCenter()

    @property
    def _has_kept(self) -> bool:
        return self._is_split and self._kept == (*self._look, self._rectangle)

    def _keep(self) -> None:
        if not self.is_settled:
            return
        left, right, bottom, top = self._rectangle
        size = right - left, top - bottom
        if self._frame is None:
            self._frame = vtkOpenGLFramebufferObject()
            self._frame.SetContext(self._window.render_window)
        state = self._window.render_window.GetState()
        state.PushFramebufferBindings()
        if self._frame.GetLastSize() != size:
            self._frame.PopulateFramebuffer(
                *size, True, 1, VTK_UNSIGNED_CHAR, True, _DEPTH_BITS, 0, False
            )
        state.PopFramebufferBindings()
        drawn = self._window.render_window.GetRenderFramebuffer()
        copy_frame(self._window, drawn, self._rectangle, self._frame, self._whole, COLORS | DEPTHS)
        self._kept = (*self._look, self._rectangle)

    def _lay(self) -> None:
        if self.still.GetDraw() or self._frame is None:
            return
        drawn = self._window.render_window.GetRenderFramebuffer()
        copy_frame(self._window, self._frame, self._whole, drawn, self._rectangle, COLORS | DEPTHS)

    def _see_through(self) -> None:
        if self._scene is not None:
            self._scene.see_through(self.translucent)

    def _note(self) -> None:
        self._drawn = self._look

    @property
    def _whole(self) -> Rectangle:
        left, right, bottom, top = self._rectangle
        return 0, right - left, 0, top - bottom


def _fill(renderer: vtkRenderer, actors: Iterable[vtkProp3D]) -> None:
    renderer.RemoveAllViewProps()
    for actor in actors:
        renderer.AddActor(actor)


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
        # Through another buffer: no part of a buffer may be copied over itself.
        copy_frame(window, drawn, corner, spare, corner)
        # Its last pixels are mixed with those beyond: the same again, not those of another picture.
        last_row, beyond = (0, right, top - 1, top), (0, right, top, top + 1)
        copy_frame(window, drawn, last_row, spare, beyond)
        last_column, beside = (right - 1, right, 0, top), (right, right + 1, 0, top)
        copy_frame(window, drawn, last_column, spare, beside)
        whole = (0, width, 0, height)
        copy_frame(window, spare, corner, drawn, whole, filtering=LINEAR)
