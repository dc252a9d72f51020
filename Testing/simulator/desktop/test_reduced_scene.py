"""At the lowest quality a large window draws its scene coarser; what is read stays sharp."""

import numpy as np
import pytest

from rastrainer_simulator.desktop import kept_view
from rastrainer_simulator.desktop.gl_window import GlWindow
from rastrainer_simulator.desktop.inbox import Inbox, LoadedScene, read_parts
from rastrainer_simulator.desktop.picture import Picture
from rastrainer_simulator.desktop.viewports import Quality
from Testing.simulator.desktop.conftest import BODIES, FIDUCIALS, SCREEN, VIEWPOINTS, state_text

SIZE = (1601, 901)
"""Odd: half of it is no whole number of pixels."""


@pytest.fixture
def draw(glb, monkeypatch):
    """Return a function that draws with a quality and that many pixels at most."""
    monkeypatch.setenv("SDL_VIDEODRIVER", "offscreen")
    inbox = Inbox()
    inbox.bodies, inbox.screen, inbox.problem = BODIES, SCREEN, ""
    inbox.scene = LoadedScene(read_parts(glb, BODIES), VIEWPOINTS, FIDUCIALS)
    window = GlWindow(SIZE, is_fullscreen=False)

    def draw(quality, most=kept_view.MAX_PIXELS):
        monkeypatch.setattr(kept_view, "MAX_PIXELS", most)
        picture = Picture(window, inbox, quality)
        inbox.take_state(state_text())
        assert picture.is_due(0.0)
        picture.draw()
        for renderer in list(window.render_window.GetRenderers()):
            window.render_window.RemoveRenderer(renderer)
        return picture, window.pixels().astype(int)

    yield draw
    window.close()


def test_the_scene_is_coarser_at_the_same_place_and_texts_and_inset_are_not(draw):
    picture, coarse = draw(Quality.LOW)
    _, fine = draw(Quality.LOW, most=10**9)
    differs = np.abs(coarse - fine).max(axis=2) > 16
    assert picture.viewports.main.GetViewport()[2:] == (800 / 1601, 450 / 901)
    # Only edges differ: everything is where it was.
    assert 0.0005 < differs.mean() < 0.05
    assert np.abs(coarse - fine).mean() < 1.0
    box = picture.viewports.inset_box
    for kept in (
        (slice(box.top, box.top + box.height), slice(box.left, box.left + box.width)),
        (slice(20, 60), slice(600, 1000)),
    ):
        assert fine[kept].std() > 5
        np.testing.assert_array_equal(coarse[kept], fine[kept])


def test_a_window_is_scaled_down_to_what_a_processor_can_draw_and_never_up(monkeypatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "offscreen")
    window = GlWindow(SIZE, is_fullscreen=False)
    sizes = [window.shrink_to(most) or window.size for most in ((1280, 720), SIZE)]
    window.close()
    assert sizes == [(1280, 720), (1280, 720)]


def test_with_a_graphics_processor_the_scene_keeps_its_resolution(draw):
    picture, _ = draw(Quality.MEDIUM)
    assert picture.viewports.main.GetViewport() == (0.0, 0.0, 1.0, 1.0)
