"""The picture: the scene through two cameras, as well as the machine draws, and a layer over it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace
from enum import Enum

from vtkmodules.vtkRenderingCore import vtkRenderer

from rastrainer_simulator.desktop.gl_window import GlWindow, is_software_renderer
from rastrainer_simulator.desktop.inbox import Viewpoint
from rastrainer_simulator.desktop.kept_view import KeptView, ReducedScene
from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.panels.canvas import Box
from rastrainer_simulator.desktop.shown_scene import ShownScene
from rastrainer_simulator.presentation.look import FLIGHT_S
from rastrainer_simulator.presentation.messages import CoveringBodies
from rastrainer_simulator.rendering.lighting import Shadows, add_plain_lights, light_room

BACKGROUND = (0.62, 0.65, 0.68)


class Quality(str, Enum):
    """What a picture is made of.

    High has physically based light, soft shadows, shaded corners and smooth edges; medium leaves
    shadows and shaded corners out; low is plain light, and in large windows a fraction of the
    resolution, for machines without a graphics processor.
    """

    HIGH = "high"
    MEDIUM = "medium"
    LOW = "low"

    @property
    def is_physical(self) -> bool:
        """Whether surfaces are physically based."""
        return self is not Quality.LOW

    @property
    def next_lower(self) -> Quality:
        return Quality.MEDIUM if self is Quality.HIGH else Quality.LOW


def first_quality(renderer_name: str) -> Quality:
    """Return the initial quality, by OpenGL's name of the renderer."""
    return Quality.LOW if is_software_renderer(renderer_name) else Quality.HIGH


class CameraTransition:
    """The move of a camera to a viewpoint, which starts and ends gently."""

    def __init__(self, start: Viewpoint):
        self._from = self._to = start
        self._since = -FLIGHT_S

    def start(self, to: Viewpoint, now: float) -> None:
        self._from, self._to, self._since = self.at(now), to, now

    def follow(self, to: Viewpoint) -> None:
        """Replace the destination by one that itself moves, or by one that is already reached."""
        self._to = to

    def is_moving(self, now: float) -> bool:
        return now - self._since < FLIGHT_S

    def at(self, now: float) -> Viewpoint:
        """Return where the camera is."""
        share = min(1.0, max(0.0, (now - self._since) / FLIGHT_S))
        return self._from.toward(self._to, share * share * (3.0 - 2.0 * share))


class Viewports:
    """Main view, inset and overlay of one window.

    Attributes:
        main: renderer of the chosen camera.
        overlay: renderer for two-dimensional actors.
        wants_inset: whether a second view is shown.
    """

    def __init__(self, window: GlWindow, quality: Quality):
        self._window = window
        window.render_window.SetNumberOfLayers(2)
        self._main, self._inset = KeptView(window), KeptView(window)
        self.main = self._main.still
        for view in (self._main, self._inset):
            view.still.SetBackground(*BACKGROUND)
        self.overlay = vtkRenderer()
        self.overlay.SetLayer(1)
        self.overlay.InteractiveOff()
        self.overlay.AutomaticLightCreationOff()
        window.render_window.AddRenderer(self.overlay)
        self._reduced = ReducedScene(window, self._main)
        self._scene: ShownScene | None = None
        self._cameras: dict[str, Viewpoint] = {}
        self._chosen = ("", 0.0)
        self._transition: CameraTransition | None = None
        self._beside: Viewpoint | None = None
        self.quality = quality
        self.wants_inset = True
        self._light()

    def show(self, scene: ShownScene, cameras: Mapping[str, Viewpoint]) -> None:
        scene.finish(self.quality.is_physical)
        self._scene, self._cameras, self._transition = scene, dict(cameras), None
        self.arrange()

    def arrange(self) -> None:
        """Have what stands still kept, where that saves time and looks the same."""
        if self._scene is None:
            return
        # What is seen through the skin moves, and the skin would no longer be before it.
        is_split = self.quality is Quality.LOW and not self._scene.is_clear
        for view in (self._main, self._inset):
            view.show(self._scene, is_split)

    def set_quality(self, quality: Quality) -> None:
        """Light the scene better, or faster."""
        self.quality = quality
        self._light()
        if self._scene is not None:
            self._scene.finish(quality.is_physical)
        self.arrange()

    def choose(
        self,
        camera: str,
        now: float,
        aside: float = 0.0,
        view: Viewpoint | None = None,
        beside: Viewpoint | None = None,
    ) -> None:
        """Have the main view go to a camera, and the inset show another.

        `aside` pushes the main picture to the right, in halves of its width. `view` is where the
        camera stands while it is turned, `beside` what the inset shows in place of another camera.
        """
        if camera not in self._cameras:
            return
        self._beside = beside
        viewpoint = replace(view or self._cameras[camera], aside=aside)
        if self._transition is None:
            self._transition = CameraTransition(viewpoint)
        elif (camera, aside) != self._chosen:
            self._transition.start(viewpoint, now)
        else:
            self._transition.follow(viewpoint)
        self._chosen = (camera, aside)

    def see_through(self, bodies: CoveringBodies) -> None:
        """Draw bodies translucent, those that the stream says of each picture."""
        self._main.translucent, self._inset.translucent = bodies.view, bodies.inset

    def is_moving(self, now: float) -> bool:
        """Return whether the main view's camera is moving, or has arrived and draws finer."""
        if self._transition is None:
            return False
        return self._transition.is_moving(now) or (
            self._reduced.is_coarse and self._main.is_settled
        )

    @property
    def cameras(self) -> Collection[str]:
        """Names of the existing views."""
        return self._cameras.keys()

    @property
    def inset_box(self) -> Box:
        """Where the inset is, in pixels from the upper left corner."""
        width, height = self._window.size
        unit = theme.scale_of(width, height)
        margin = round(theme.MARGIN * unit)
        wide = round(theme.INSET_SHARE * theme.REFERENCE_SIZE[0] * unit)
        high = round(theme.INSET_SHARE * theme.REFERENCE_SIZE[1] * unit)
        return Box(width - margin - wide, margin, wide, high)

    @property
    def has_inset(self) -> bool:
        """Whether the second view is to be seen."""
        return self.wants_inset and self._transition is not None and len(self._cameras) > 1

    def prepare(self, now: float) -> None:
        """Set cameras and viewports for the picture at `now` (s)."""
        is_low = self.quality is Quality.LOW
        if self._transition is not None:
            self._main.look(self._transition.at(now))
            other = next(
                (name for name in self._cameras if name != self._chosen[0]), self._chosen[0]
            )
            self._inset.look(self._beside or self._cameras[other])
        # What can be kept costs less than to enlarge what is drawn coarsely.
        self._reduced.fit(is_low and not self._main.is_settled)
        if not self.has_inset:
            self._inset.hide()
            return
        height, box = self._window.size[1], self.inset_box
        bottom = height - box.top - box.height
        self._inset.place((box.left, box.left + box.width, bottom, height - box.top))

    def _light(self) -> None:
        stills = self._main.still, self._inset.still
        for renderer in (*stills, self._main.moving, self._inset.moving):
            renderer.RemoveAllLights()
            if renderer.GetPass() is not None:
                renderer.GetPass().ReleaseGraphicsResources(self._window.render_window)
            # None takes them away again, of which VTK's stubs do not know.
            renderer.SetPass(None)  # type: ignore[arg-type]
            renderer.UseFXAAOff()
            renderer.UseImageBasedLightingOff()
            renderer.SetEnvironmentTexture(None)  # type: ignore[arg-type]
        if not self.quality.is_physical:
            for renderer in (*stills, self._main.moving, self._inset.moving):
                add_plain_lights(renderer)
            return
        has_shadows = self.quality is Quality.HIGH
        for renderer, shadows in zip(stills, (Shadows.FULL, Shadows.SMALL), strict=True):
            light_room(renderer, shadows if has_shadows else Shadows.NONE)
